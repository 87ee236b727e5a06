// The program as a user runs it: exit codes, messages, files, bytes.
#include "tests/program/program.h"

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "render/image/picture.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

TEST_F(Program, HelpAndVersionSucceed) {
  const Outcome help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command : {"render", "solve", "form-factors", "compare", "bench", "info"})
    EXPECT_NE(help.out.find(command), std::string::npos);
  EXPECT_EQ(run("--version").exit_code, 0);
  EXPECT_EQ(run("render --help").exit_code, 0);
}

TEST_F(Program, WrongUsageExitsWithTwo) {
  for (const char* arguments :
       {"", "paint", "render", "render a.xml", "render a.xml -o b.exr --spp 0", "render a.xml -o b.exr --bogus",
        "render a.xml -o b.exr --clamp-direct 0", "render a.xml -o b.exr --clamp-indirect -1",
        "render a.xml -o b.exr --camera 1,2,3", "compare a.exr", "compare a.exr b.exr --crop 1,2,3", "bench",
        "bench -o d --seeds 0", "bench -o d --solvers lu", "solve a.xml", "solve a.xml -o b.ply --elements 0",
        "solve a.xml -o b.ply --hemicube-resolution 1",
        "render a.xml -o b.exr --solution c.radiosity --solver lu",
        "render a.xml -o b.exr --elements 10 --solution c.radiosity"})
    EXPECT_EQ(run(arguments).exit_code, 2) << arguments;
}

TEST_F(Program, ErrorsAreOneLineOfWhereWhatAndWhatToDoWithExitCodeOne) {
  write("bad.xml", "<scene version='3.0.0'>\n<shape type='blob'/>\n</scene>");
  write("broken.xml", "<scene version='3.0.0'>\n<shape>");
  write("config.ocio", "not a config");
  const struct {
    std::string arguments, part;
  } cases[] = {
      {"render missing.xml -o a.exr", "missing.xml: "},
      {"render bad.xml -o a.exr", "bad.xml:2: "},
      {"render broken.xml -o a.exr", "broken.xml:"},
      {"render " + box_ + "-o a.gif", ".exr"},
      {"render " + box_ + "-o nowhere/a.exr", "nowhere"},
      {"render " + box_ + "-o a.exr --integrator magic", "twopass, unbiased, path, radiosity, direct"},
      {"render " + box_ + "-o a.exr --sampler magic", "sobol, independent, stratified"},
      {"render " + box_ + "-o a.exr --solver magic", "gauss-seidel"},
      {"render '" TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml' -o a.exr --size 0x4", "WIDTHxHEIGHT"},
      {"render " + box_ + "-o a.png --ocio config.ocio", "config.ocio"},
      {"render " + box_ + "-o a.png --view Sepia", "Sepia"},
      {"render " + box_ + "-o a.exr --camera 0,0,0,0,0,0,0,1,0", "--camera"},
      {"render " + box_ + "-o a.exr -D nonsense", "name=value"},
      {"compare missing.exr missing.exr", "missing.exr"},
      {"solve missing.xml -o a.gif", ".radiosity, .glb, .ply"},
      {"solve missing.xml -o nowhere/a.ply", "nowhere"},
      {"solve '" TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml' -o a.ply --subdivision magic",
       "uniform, adaptive"},
      {"render " + box_ + "-o a.exr --solution missing.radiosity", "missing.radiosity: "},
      {"render " + box_ + "-o a.exr --solution bad.xml", "not a radiosity solution"},
  };
  for (const auto& c : cases) {
    const Outcome result = run(c.arguments + " --quiet");
    EXPECT_EQ(result.exit_code, 1) << c.arguments << "\n" << result.err;
    EXPECT_NE(result.err.find(c.part), std::string::npos) << c.arguments << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find("; "), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "a.exr"));
  }
}

TEST_F(Program, UnreadableOcioEnvironmentIsAnErrorToo) {
  EXPECT_EQ(run("render " + box_ + "-o a.png --spp 1", "OCIO=/nonexistent.ocio").exit_code, 1);
  EXPECT_EQ(run("render " + box_ + "-o a.exr --spp 1 --quiet", "OCIO=/nonexistent.ocio").exit_code, 0)
      << "EXR needs no display";
}

TEST_F(Program, RendersAllFormatsWithStatistics) {
  const Outcome result = run("render " + box_ + "-o a.exr -o a.png -o a.jpg -o a.tif --spp 4 --stats s.json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* name : {"a.exr", "a.png", "a.jpg", "a.tif"}) {
    const Image image = read_picture(folder_ / name);
    EXPECT_EQ(image.width, 40);
    EXPECT_EQ(image.height, 40);
  }
  const auto stats = nlohmann::json::parse(read(folder_ / "s.json"));
  EXPECT_EQ(stats["render"]["integrator"], "twopass");
  EXPECT_EQ(stats["render"]["spp"], 4.0);
  EXPECT_EQ(stats["render"]["non_finite_samples"], 0);
  EXPECT_GT(stats["radiosity"]["elements"], 100);
  EXPECT_LE(stats["radiosity"]["error_bound"], 0.01);
  EXPECT_GT(stats["render"]["rays"], 6400);
}

TEST_F(Program, SameBytesOnOneAndTwoThreadsAndOtherBytesWithAnotherSeed) {
  for (const std::string integrator : {"twopass", "path", "radiosity", "direct"}) {
    const std::string arguments = "render " + box_ + "--spp 4 --integrator " + integrator;
    ASSERT_EQ(run(arguments + " -o one.exr --threads 1").exit_code, 0);
    ASSERT_EQ(run(arguments + " -o two.exr --threads 2").exit_code, 0);
    ASSERT_EQ(run(arguments + " -o seed.exr --seed 7").exit_code, 0);
    EXPECT_EQ(read(folder_ / "one.exr"), read(folder_ / "two.exr")) << integrator;
    EXPECT_NE(read(folder_ / "one.exr"), read(folder_ / "seed.exr")) << integrator;
  }
}

TEST_F(Program, EverySamplerOnAnyNumberOfThreads) {
  std::set<std::string> pictures;
  for (const std::string sampler : {"sobol", "independent", "stratified"}) {
    const std::string arguments = "render " + box_ + "--integrator direct --spp 4 --sampler " + sampler;
    ASSERT_EQ(run(arguments + " -o one.exr --threads 1").exit_code, 0);
    ASSERT_EQ(run(arguments + " -o two.exr --threads 2 --stats s.json").exit_code, 0);
    EXPECT_EQ(read(folder_ / "one.exr"), read(folder_ / "two.exr")) << sampler;
    EXPECT_EQ(nlohmann::json::parse(read(folder_ / "s.json"))["render"]["sampler"], sampler);
    pictures.insert(read(folder_ / "one.exr"));
  }
  EXPECT_EQ(pictures.size(), 3u);
  ASSERT_EQ(run("render " + box_ + "--integrator direct --spp 4 -o one.exr").exit_code, 0);
  EXPECT_TRUE(pictures.contains(read(folder_ / "one.exr")));
}

TEST_F(Program, ANoiseGoalStopsPixelsEarlyAndSaysSo) {
  const std::string arguments = "render " + box_ + "--integrator path --noise 0.06";
  const Outcome one = run(arguments + " -o one.exr --threads 1 --stats s.json");
  ASSERT_EQ(one.exit_code, 0) << one.err;
  ASSERT_EQ(run(arguments + " -o two.exr --threads 2").exit_code, 0);
  EXPECT_EQ(read(folder_ / "one.exr"), read(folder_ / "two.exr"));
  EXPECT_NE(one.out.find("(stopped by noise)"), std::string::npos) << one.out;
  EXPECT_NE(one.out.find("% of the pixels stopped early"), std::string::npos) << one.out;
  const auto stats = nlohmann::json::parse(read(folder_ / "s.json"));
  EXPECT_EQ(stats["render"]["stop_reason"], "noise");
  EXPECT_GT(stats["render"]["pixels_stopped_early"], 0.1);
  EXPECT_LE(stats["render"]["relative_error"], 0.06);
}

TEST_F(Program, ClampsAreSaidEverywhere) {
  const std::string arguments = "render " + box_ + "--integrator path --spp 4 -o a.exr --stats s.json ";
  const Outcome result = run(arguments + "--clamp-direct 4 --clamp-indirect 0.5");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string words = "direct light clamped to 4, indirect light clamped to 0.5";
  EXPECT_NE(result.out.find("biased: " + words + " W/(m2 sr)"), std::string::npos) << result.out;
  EXPECT_NE(read(folder_ / "a.exr").find(words), std::string::npos) << "twopass/bias";
  EXPECT_EQ(nlohmann::json::parse(read(folder_ / "s.json"))["render"]["clamped"], words);
  const std::string clamped = read(folder_ / "a.exr");
  const Outcome free = run(arguments);
  EXPECT_EQ(free.out.find("biased"), std::string::npos);
  EXPECT_EQ(read(folder_ / "a.exr").find("twopass/bias"), std::string::npos);
  EXPECT_TRUE(nlohmann::json::parse(read(folder_ / "s.json"))["render"]["clamped"].is_null());
  EXPECT_NE(read(folder_ / "a.exr"), clamped);
}

const std::string cornell_box = "'" TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml' ";

TEST_F(Program, ASavedSolutionGivesTheSamePictureWithoutSolving) {
  ASSERT_EQ(run("solve " + cornell_box + "-o s.radiosity --elements 800 --stats s.json").exit_code, 0);
  for (const std::string integrator : {"twopass", "radiosity"}) {
    const std::string arguments = "render " + box_ + "--spp 4 --integrator " + integrator;
    const Outcome loaded = run(arguments + " -o a.exr --solution s.radiosity --stats a.json");
    ASSERT_EQ(loaded.exit_code, 0) << loaded.err;
    EXPECT_NE(loaded.err.find("radiosity pass: taken from s.radiosity"), std::string::npos);
    ASSERT_EQ(run(arguments + " -o b.exr --elements 800").exit_code, 0);
    EXPECT_EQ(read(folder_ / "a.exr"), read(folder_ / "b.exr")) << integrator;
    const auto solved = nlohmann::json::parse(read(folder_ / "s.json")),
               rendered = nlohmann::json::parse(read(folder_ / "a.json"));
    EXPECT_EQ(solved["radiosity"], rendered["radiosity"]);
    EXPECT_LT(rendered["seconds"]["radiosity"], solved["seconds"]["radiosity"]);
  }
  // Of another scene, of other paths, not needed.
  const Outcome other = run("render '" TWOPASS_SOURCE_DIR
                            "/scenes/hidden/scene.xml' --size 40x40 --spp 1 -o c.exr --solution s.radiosity");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_NE(other.err.find("s.radiosity: this solution belongs to another scene; "), std::string::npos);
  const Outcome shorter = run("render " + box_ + "--spp 1 -o c.exr --solution s.radiosity --max-depth 5");
  EXPECT_EQ(shorter.exit_code, 1);
  EXPECT_NE(shorter.err.find("--max-reflections 2"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "c.exr"));
  const Outcome path = run("render " + box_ + "--spp 1 -o c.exr --solution s.radiosity --integrator path");
  EXPECT_EQ(path.exit_code, 0);
  EXPECT_NE(path.err.find("s.radiosity: not needed, because"), std::string::npos);

  ASSERT_EQ(run("solve " + cornell_box + "-o t.radiosity --elements 800 --max-reflections 2").exit_code, 0);
  ASSERT_EQ(run("render " + box_ + "--spp 4 --max-depth 5 -o a.exr --solution t.radiosity").exit_code, 0);
  ASSERT_EQ(run("render " + box_ + "--spp 4 --max-depth 5 -o b.exr --elements 800").exit_code, 0);
  EXPECT_EQ(read(folder_ / "a.exr"), read(folder_ / "b.exr"));
}

TEST_F(Program, SolveWritesAllFormatsAndASummary) {
  const Outcome result =
      run("solve " + cornell_box + "-o s.radiosity -o s.glb -o s.ply --elements 300 --stats s.json --seed 3");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* part : {"solver        cg\n", "form factors  rays\n", "elements ", "links ", "iterations ",
                           "rays ", "residual ", "error bound ", "time ", "memory ", "wrote s.radiosity\n",
                           "wrote s.glb\n", "wrote s.ply\n"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << result.out;
  EXPECT_EQ(read(folder_ / "s.glb").substr(0, 4), "glTF");
  EXPECT_EQ(read(folder_ / "s.ply").substr(0, 4), "ply\n");
  const auto stats = nlohmann::json::parse(read(folder_ / "s.json"));
  EXPECT_TRUE(stats["render"].is_null());
  EXPECT_EQ(stats["radiosity"]["solver"], "cg");
  EXPECT_GT(stats["radiosity"]["elements"], 100);
  EXPECT_GT(stats["scene"]["triangles"], 20);
  EXPECT_EQ(stats["seed"], 3);
  EXPECT_EQ(run("solve " + cornell_box + "-o s.radiosity --elements 300 --quiet").out, "");
}

TEST_F(Program, SolveKnowsEverySolverAndMethod) {
  for (const char* way :
       {"--solver lu", "--solver jacobi", "--solver gauss-seidel", "--solver progressive",
        "--solver progressive --overshoot", "--solver cg", "--solver hierarchical --radiosity-error 0.1",
        "--solver stochastic --radiosity-error 0.1", "--form-factors exact", "--form-factors point",
        "--form-factors hemicube --hemicube-resolution 16", "--form-factors rays", "--subdivision adaptive"}) {
    const Outcome result = run("solve " + cornell_box + "-o s.radiosity --elements 150 " + way);
    EXPECT_EQ(result.exit_code, 0) << way << result.err;
    EXPECT_NE(result.out.find("residual "), std::string::npos) << way;
    EXPECT_NE(result.out.find("error bound "), std::string::npos) << way;
  }
  EXPECT_EQ(run("solve " + cornell_box + "-o s.radiosity --solver stochastic --form-factors exact").exit_code,
            1);
  EXPECT_EQ(run("solve " + cornell_box + "-o s.radiosity --solver cg --overshoot").exit_code, 1);
  EXPECT_EQ(run("solve " + cornell_box + "-o s.radiosity --solver none").exit_code, 1);
}

TEST_F(Program, ScenesWithoutLightOrDiffuseSurfacesAreSolvedToo) {
  write("dark.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome result = run("solve dark.obj --sky 0,0,0 -o s.radiosity -o s.glb -o s.ply");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("nothing emits light"), std::string::npos);
  // A sky makes it another scene.
  EXPECT_EQ(run("render dark.obj -o a.exr --spp 1 --size 8x8 --sky 1,1,1 --solution s.radiosity").exit_code, 1);
  ASSERT_EQ(run("solve dark.obj -o s.radiosity").exit_code, 0);  // the same as --sky 1,1,1
  EXPECT_EQ(run("render dark.obj -o a.exr --spp 1 --size 8x8 --sky 1,1,1 --solution s.radiosity").exit_code, 0);
}

TEST_F(Program, CompareMeasuresAndEnforcesLimits) {
  ASSERT_EQ(run("render " + box_ + "-o a.exr --spp 4").exit_code, 0);
  ASSERT_EQ(run("render " + box_ + "-o b.exr --spp 4 --seed 3").exit_code, 0);
  ASSERT_EQ(run("compare a.exr a.exr --json same.json").exit_code, 0);
  const auto same = nlohmann::json::parse(read(folder_ / "same.json"));
  EXPECT_EQ(same["mse"], 0.0);
  EXPECT_EQ(same["flip"], 0.0);
  EXPECT_EQ(same["energy_ratio"][1], 1.0);
  for (const char* key :
       {"energy_ratio", "mse", "relmse", "relmse_trimmed", "smape", "psnr", "flip", "non_finite", "size"})
    EXPECT_TRUE(same.contains(key)) << key;
  EXPECT_EQ(run("compare a.exr b.exr --max relmse=10 --max flip=1").exit_code, 0);
  const Outcome exceeded = run("compare a.exr b.exr --max relmse=1e-9");
  EXPECT_EQ(exceeded.exit_code, 1);
  EXPECT_NE(exceeded.err.find("relmse"), std::string::npos);
  EXPECT_EQ(run("compare a.exr b.exr --max beauty=1").exit_code, 1);
}

TEST_F(Program, CompareAPartAndWriteAReport) {
  ASSERT_EQ(run("render " + box_ + "-o a.exr --spp 4").exit_code, 0);
  ASSERT_EQ(run("render " + box_ + "-o b.exr --spp 4 --seed 3").exit_code, 0);
  ASSERT_EQ(run("compare a.exr b.exr --crop 30,20,10,15 --json part.json --html part.html").exit_code, 0);
  const auto part = nlohmann::json::parse(read(folder_ / "part.json"));
  EXPECT_EQ(part["size"], nlohmann::json({10, 15}));
  for (const char* key : {"bias2", "variance", "energy_ci95"}) EXPECT_TRUE(part.contains(key)) << key;
  EXPECT_NE(read(folder_ / "part.html").find("a.exr against b.exr"), std::string::npos);
  const Outcome beyond = run("compare a.exr b.exr --crop 31,20,10,15");
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_NE(beyond.err.find("inside of 40x40"), std::string::npos) << beyond.err;
  EXPECT_EQ(run("compare a.exr b.exr --html nowhere/a.html").exit_code, 1);
}

TEST_F(Program, BenchWritesItsFilesAndKeepsReferences) {
  const std::string command = "bench '" TWOPASS_SOURCE_DIR
                              "/scenes/cornell-box/scene.xml' -o out --size 16 --seeds 2 --time 0.2 "
                              "--reference-time 0.4 --no-peers --integrators path,twopass";
  ASSERT_EQ(run(command).exit_code, 0);
  const auto results = nlohmann::json::parse(read(folder_ / "out/results.json"));
  EXPECT_EQ(results["complete"], true);
  const auto& scene = results["scenes"][0];
  EXPECT_EQ(scene["name"], "cornell-box");
  EXPECT_EQ(scene["reference"]["cached"], false);
  EXPECT_GT(scene["reference"]["own_relmse"], 0.0);
  ASSERT_EQ(scene["series"].size(), 2u);
  const auto& points = scene["series"][0]["points"];
  ASSERT_GE(points.size(), 2u);
  EXPECT_GT(points.front()["relmse"], points.back()["relmse"]) << "more samples, less error";
  EXPECT_GT(scene["series"][1]["points"][0]["pass_one_seconds"], 0.0);
  EXPECT_EQ(scene["series"][0]["points"][0]["pass_one_share"], 0.0);
  EXPECT_EQ(read(folder_ / "out/results.csv").substr(0, 13), "scene,method,");
  EXPECT_NE(read(folder_ / "out/report.html").find("<svg"), std::string::npos);
  ASSERT_EQ(run(command + " --pass-one --solvers cg,stochastic --form-factors rays --elements 200").exit_code,
            0);
  const auto pass_one = nlohmann::json::parse(read(folder_ / "out/results.json"))["scenes"][0];
  EXPECT_EQ(pass_one["reference"]["cached"], true);
  ASSERT_EQ(pass_one["pass_one"].size(), 2u);
  EXPECT_EQ(pass_one["pass_one"][1]["solver"], "stochastic");
  for (const auto& result : pass_one["pass_one"]) EXPECT_NEAR(result["energy_ratio"][0], 1.0, 0.1);
  EXPECT_EQ(run("bench missing.xml -o out --no-peers --minutes 0.01").exit_code, 1);
}

TEST_F(Program, InfoTellsWhatIsThereAndWhatIsSkipped) {
  const Outcome result =
      run("info " + std::string("'" TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml' --json"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto info = nlohmann::json::parse(result.out);
  EXPECT_GT(info["triangles"], 20);
  EXPECT_TRUE(info["needs"]["radiosity_pass"]);
  write("dark.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto dark = nlohmann::json::parse(run("info dark.obj --json").out);
  EXPECT_FALSE(dark["needs"]["radiosity_pass"]);
  EXPECT_EQ(dark["skipped"][0]["what"], "radiosity pass");
}

TEST_F(Program, InfoHelpsToFindMistakes) {
  // A cube that is turned inside out, with one face missing, far from a camera that looks away.
  write("room.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 4 3 7 8\nf 1 4 8 5\nf 2 6 7 3\n");
  write("away.xml",
        "<scene version='3.0.0'><sensor type='perspective'><transform name='to_world'>"
        "<lookat origin='0,0,5' target='0,0,9' up='0,1,0'/></transform></sensor>"
        "<shape type='obj' id='cube'><string name='filename' value='room.obj'/>"
        "<boolean name='face_normals' value='true'/></shape>"
        "<emitter type='point'/></scene>");
  const auto info = nlohmann::json::parse(run("info away.xml --json").out);
  EXPECT_FALSE(info["camera"]["sees_bounds"].get<bool>());
  EXPECT_FALSE(info["camera"]["inside_bounds"].get<bool>());
  EXPECT_EQ(info["emitters"]["punctual"]["point"], 1);
  EXPECT_EQ(info["shapes_by_name"][0]["name"], "cube");
  EXPECT_TRUE(info["shapes_by_name"][0]["closed"].get<bool>());
  EXPECT_NEAR(info["shapes_by_name"][0]["area"].get<double>(), 6.0, 1e-6);
  const Outcome text = run("info away.xml --verbose");
  EXPECT_NE(text.out.find("look at: the camera looks past everything"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("look at: shape 'cube' is closed and its front is inside"), std::string::npos)
      << text.out;
  EXPECT_NE(text.out.find("open_edges"), std::string::npos) << "a table of shapes";
  EXPECT_NE(run("info room.obj").out.find("look at: there is no camera"), std::string::npos);
}

TEST_F(Program, WhatIsNotSupportedCanBeLeftOut) {
  write("some.xml",
        "<scene version='3.0.0'>\n<shape type='sdfgrid'/>\n<shape type='sphere'><bsdf type='hair'/></shape>\n"
        "<shape type='sdfgrid'/>\n<emitter type='constant'/></scene>");
  const Outcome refused = run("render some.xml -o a.exr --spp 1 --size 8x8");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("some.xml:2: shape 'sdfgrid' is not supported; supported shapes: "),
            std::string::npos)
      << refused.err;
  for (const char* command : {"render some.xml -o a.exr --spp 1 --size 8x8 --stats s.json",
                              "solve some.xml -o a.ply", "info some.xml"}) {
    const Outcome rest = run(std::string(command) + " --ignore-unsupported");
    EXPECT_EQ(rest.exit_code, 0) << command << rest.err;
    EXPECT_NE(rest.err.find("left out: 1 bsdf 'hair', at "), std::string::npos) << rest.err;
    EXPECT_NE(rest.err.find("left out: 2 shapes 'sdfgrid', the first at "), std::string::npos) << rest.err;
  }
  EXPECT_GE(nlohmann::json::parse(read(folder_ / "s.json"))["scene"]["skipped"].size(), 2u);
}

TEST_F(Program, UnknownNamesAreFollowedByTheKnown) {
  EXPECT_NE(run("render a.xml -o b.exr --bogus").err.find("--integrator"), std::string::npos);
  const Outcome command = run("info --bogus x.xml");
  EXPECT_EQ(command.exit_code, 2);
  EXPECT_NE(command.err.find("its options:"), std::string::npos) << command.err;
}

// A window of a picture is what the whole picture has there, to the bit; .exr files remember where it lies.
TEST_F(Program, ACropIsAPartOfThePicture) {
  ASSERT_EQ(run("render " + box_ + "-o whole.exr --exr-type float --spp 4 --integrator path").exit_code, 0);
  ASSERT_EQ(run("render " + box_ +
                "-o part.exr -o part.png --exr-type float --spp 4 --integrator path --crop 10,20,16,8")
                .exit_code,
            0);
  const Image whole = read_picture(folder_ / "whole.exr"), part = read_picture(folder_ / "part.exr");
  ASSERT_EQ(part.width, 16);
  ASSERT_EQ(part.height, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x)
      for (int c = 0; c < 4; ++c) ASSERT_EQ(part.at(x, y, c), whole.at(x + 10, y + 20, c)) << x << ' ' << y;
  EXPECT_EQ(read_picture(folder_ / "part.png").width, 16);
  const Outcome outside = run("render " + box_ + "-o part.exr --spp 1 --crop 30,0,20,8");
  EXPECT_EQ(outside.exit_code, 1);
  EXPECT_NE(outside.err.find("--crop: the window reaches beyond the picture"), std::string::npos);
}

TEST_F(Program, FormFactorsOfTheUnitCubeAsJson) {
  write("cube.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "g floor\nf 1 2 3 4\ng ceiling\nf 5 8 7 6\ng near\nf 1 5 6 2\ng far\nf 4 3 7 8\ng left\nf 1 4 8 5\ng "
        "right\nf 2 6 7 3\n");
  const Outcome result = run("form-factors cube.obj --json --method exact");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  ASSERT_EQ(json["shapes"].size(), 6u);
  EXPECT_EQ(json["shapes"][0]["name"], "floor");
  EXPECT_NEAR(json["F"][0][1].get<double>(), 0.19982489569838738, 1e-9);
  EXPECT_NEAR(json["F"][0][2].get<double>(), 0.20004377607540315, 1e-9);
  EXPECT_LT(json["closure_error"].get<double>(), 1e-6);
}

TEST_F(Program, FormFactorsByEveryMethodAndAsATable) {
  write(
      "plates.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv 0 0 .5\nv 1 0 .5\nv 1 1 .5\n"
      "v 0 1 .5\ng lower\nf 1 2 3 4\ng a_name_that_is_longer_than_any_column_of_a_table\nf 5 8 7 6\ng screen\n"
      "f 9 10 11 12\n");
  for (const char* method :
       {"exact", "point", "hemicube --hemicube-resolution 16", "rays --rays 1000", "auto"}) {
    const Outcome result = run("form-factors plates.obj --json --method " + std::string(method));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_LT(json["F"][0][1].get<double>(), 1e-9) << method;  // behind the screen
    EXPECT_FALSE(json["closed"].get<bool>());
    EXPECT_GT(json["closure_error_before"].get<double>(), 0.1);
    const auto open = nlohmann::json::parse(
        run("form-factors plates.obj --json --no-occlusion --method " + std::string(method)).out);
    EXPECT_NEAR(open["F"][0][1].get<double>(), 0.19982489569838738, 0.04)
        << method;  // point and hemicube are crude so near
  }
  const Outcome table = run("form-factors plates.obj");
  EXPECT_NE(table.out.find("a_name_that_is_longer_tha..."), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("not closed"), std::string::npos);
  EXPECT_EQ(run("form-factors plates.obj --method hemicube --hemicube-resolution 7").exit_code, 1);
  EXPECT_EQ(run("form-factors plates.obj --hemicube-resolution 0").exit_code, 2);
}

TEST_F(Program, AnObjWithoutCameraAndLightIsShownUnderANeutralSky) {
  write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome result = run("render tri.obj -o a.exr --spp 16 --size 32x32");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("no camera and no light: all of it is framed, under a neutral sky"),
            std::string::npos);
  const Image image = read_picture(folder_ / "a.exr");
  EXPECT_NEAR(image.rgb(0, 0).x, 1.0f, 1e-3f) << "the sky";
  // Grey (0.5) under a sky of radiance 1 has the radiance 0.5.
  bool found = false;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) found |= std::abs(image.rgb(x, y).x - 0.5f) < 0.02f;
  EXPECT_TRUE(found);
  EXPECT_NE(run("render tri.obj -o a.exr --spp 1 --size 8x8 --sky 0,0,0").err.find("will be black"),
            std::string::npos);
}

TEST_F(Program, NamesFromFilesDoNotCommandTheTerminal) {
  write("names.obj",
        "o red\x1b[31m\xc2\x9bm \x7f\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl \x1b]0;mine\x07\nf 1 2 3\n");
  write("names.xml", "<scene version='3.0.0'>\n<shape type='a&#10;b&#x1b;[2J'/></scene>");
  for (const char* arguments : {"info names.obj --verbose", "form-factors names.obj", "info names.xml"}) {
    const Outcome result = run(arguments);
    for (const char c : result.out + result.err) EXPECT_TRUE(c == '\n' || (c != '\x7f' && (c < 0 || c >= ' ')));
    EXPECT_EQ((result.out + result.err).find("\xc2\x9b"), std::string::npos) << arguments;
  }
  EXPECT_EQ(std::ranges::count(run("info names.xml").err, '\n'), 1);
}

TEST_F(Program, AClosedRoomWithoutCameraAndLightIsSeenFromInsideUnderALamp) {
  write("room.obj",
        "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 0 0 5\nv 4 0 5\nv 4 3 5\nv 0 3 5\n"
        "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 4 3 7 8\nf 1 4 8 5\nf 2 6 7 3\n");
  const Outcome result = run("render room.obj -o a.exr --spp 16 --size 32x24");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(
      result.err.find("room.obj: no camera and no light: a closed room, seen from one of its corners, under "
                      "a lamp of our own (--camera and --fov, --sky or --envmap give another"),
      std::string::npos)
      << result.err;
  const Image image = read_picture(folder_ / "a.exr");
  double sum = 0.0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x) {
      EXPECT_GT(image.rgb(x, y).x, 0.02f) << x << ' ' << y;
      sum += std::min(image.rgb(x, y).x, 1.0f);
    }
  EXPECT_GT(sum / (24 * 32), 0.2);
  EXPECT_LT(sum / (24 * 32), 0.8);
  // A sky that is asked for is all there is.
  const Outcome sky = run("render room.obj -o a.exr --spp 4 --size 8x8 --sky 1,1,1");
  EXPECT_NE(sky.err.find("no camera: a closed room, seen from one of its corners (--camera"), std::string::npos)
      << sky.err;
  EXPECT_EQ(read_picture(folder_ / "a.exr").rgb(4, 4), C3f(0.0f));
}

TEST_F(Program, AnObjWithoutCameraIsFramedAndSaysSo) {
  write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome result = run("render tri.obj -o a.exr --sky 1,1,1 --spp 4 --size 32x32");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("camera"), std::string::npos);
  float brightest = 0.0f, lowest_alpha = 1.0f;
  const Image image = read_picture(folder_ / "a.exr");
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      brightest = std::max(brightest, image.rgb(x, y).x);
      lowest_alpha = std::min(lowest_alpha, image.at(x, y, 3));
    }
  EXPECT_GT(brightest, 0.3f);
  EXPECT_EQ(lowest_alpha, 0.0f);
}

// Runs the program on the Cornell box, presses Ctrl-C after two seconds, and returns the exit code.
int exit_code_of_interrupted(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(),
                   {"render", TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml", "--quiet"});
  RunningProgram program(arguments);
  sleep(2);
  program.send(SIGINT);
  return program.wait();
}

TEST_F(Program, InterruptWritesWhatThereIsAndExitsWith130) {
  const fs::path picture = folder_ / "a.exr";
  EXPECT_EQ(exit_code_of_interrupted(
                {"--integrator", "path", "--size", "64x64", "--spp", "60000", "-o", picture.string()}),
            130);
  EXPECT_EQ(read_picture(picture).width, 64);
}

TEST_F(Program, InterruptBeforeTheFirstSampleKeepsTheOldPicture) {
  write("a.exr", "an older picture");
  // Pass one alone takes minutes here.
  EXPECT_EQ(exit_code_of_interrupted(
                {"--elements", "2000000", "--radiosity-error", "1e-9", "-o", (folder_ / "a.exr").string()}),
            130);
  EXPECT_EQ(read(folder_ / "a.exr"), "an older picture");
}

TEST_F(Program, AFailedWriteLeavesTheOldPictureAlone) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  ASSERT_EQ(run("render " + box_ + "-o a.exr --spp 1").exit_code, 0);
  const std::string before = read(folder_ / "a.exr");
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  const int code = std::system(
      ("'" TWOPASS_PROGRAM "' render " + box_ + "-o '" + (folder_ / "a.exr").string() + "' --spp 1 2>/dev/null")
          .c_str());
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_EQ(WEXITSTATUS(code), 1);
  EXPECT_EQ(read(folder_ / "a.exr"), before);
}

}  // namespace
}  // namespace twopass
