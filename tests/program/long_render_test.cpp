// Long renders as a user runs them: slices and merge, checkpoints and going on, signals, disks that are full or
// gone, the preview.
#include <chrono>
#include <thread>

#include "render/image/picture.h"
#include "tests/program/program.h"
#include "tests/support/viewer.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

const std::string scene = TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml";

class LongRender : public Program {
 protected:
  static std::string sized(const std::string& size, const std::string& integrator = "path") {
    return "render '" + scene + "' --size " + size + " --integrator " + integrator +
           " --exr-type float --quiet ";
  }
  const std::string path_ = sized("40x40");

  Outcome good(const std::string& arguments) const {
    Outcome result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << result.err;
    return result;
  }
  // That it fails with one clear line.
  void expect_error(const std::string& arguments, const std::string& part) const {
    const Outcome result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << arguments << "\n" << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << arguments << "\n" << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find("; "), std::string::npos) << result.err;
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }
  // Waits for the file, at most two minutes: the machine may have other things to do.
  [[nodiscard]] bool appears(const std::string& name) const {
    for (int i = 0; i < 12000 && !fs::exists(folder_ / name); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return fs::exists(folder_ / name);
  }
  // The largest difference of two pictures, relative to 1 or what is there.
  [[nodiscard]] double difference(const std::string& a, const std::string& b) const {
    const Image x = read_picture(folder_ / a), y = read_picture(folder_ / b);
    if (x.width != y.width || x.height != y.height || x.channels != y.channels) return 1e30;
    double most = 0.0;
    for (std::size_t i = 0; i < x.pixels.size(); ++i)
      most = std::max(most, std::abs(static_cast<double>(x.pixels[i]) - y.pixels[i]) /
                                std::max(1.0, std::abs(static_cast<double>(x.pixels[i]))));
    return most;
  }
  // The arguments of a render that takes some seconds, to be killed.
  [[nodiscard]] std::vector<std::string> slow(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"render", scene, "--size", "64x64", "--integrator", "path"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

TEST_F(LongRender, SlicesMergedInAnyOrderAreTheWholePicture) {
  good(path_ + "--spp 16 -o whole.exr -o whole.png");
  for (const char* k : {"1", "2", "3"}) good(path_ + "--spp 16 --slice " + k + "/3 -o part" + k + ".exr");
  good("merge part3.exr part1.exr part2.exr -o merged.exr -o merged.png");
  EXPECT_LT(difference("whole.exr", "merged.exr"), 2e-7);
  EXPECT_LT(difference("whole.png", "merged.png"), 0.02) << "a level of 255";
  EXPECT_GT(difference("whole.exr", "part1.exr"), 0.01) << "a part is another picture";
  good("merge part1.exr part2.exr part3.exr -o again.exr");
  EXPECT_EQ(read(folder_ / "merged.exr"), read(folder_ / "again.exr")) << "order does not matter";
  // In two steps, one part being a merged one.
  good("merge part1.exr part3.exr --checkpoint two.exr");
  const Outcome last = run("merge two.exr part2.exr -o steps.exr");
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_EQ(last.err, "");
  EXPECT_NE(last.out.find("2 parts, 40x40, 16 samples a pixel, estimated noise"), std::string::npos)
      << last.out;
  EXPECT_LT(difference("whole.exr", "steps.exr"), 2e-7);
  // What is missing is said.
  const Outcome some = good("merge part3.exr part1.exr -o some.exr");
  EXPECT_NE(some.err.find("samples 5 to 9 of 16 are in none of the parts"), std::string::npos) << some.err;
  // Counted from zero: 0/3 is 3/3.
  good(path_ + "--spp 16 --slice 0/3 -o part0.exr");
  good(path_ + "--spp 16 --slice 3/3 -o again.exr");
  EXPECT_EQ(read(folder_ / "part0.exr"), read(folder_ / "again.exr"));
  // Half floats unless asked otherwise, like render.
  good("merge part1.exr part2.exr part3.exr -o half.exr --exr-type half");
  EXPECT_LT(difference("half.exr", "whole.exr"), 1e-3);
  EXPECT_GT(difference("half.exr", "whole.exr"), 1e-6);
}

TEST_F(LongRender, SlicesShareASolution) {
  good("solve '" + scene + "' -o s.radiosity --elements 600 --quiet");
  const std::string arguments = "render " + box_ + "--solution s.radiosity --spp 8 --exr-type float --quiet ";
  good(arguments + "-o whole.exr");
  good(arguments + "-o a.exr --slice 1/2");
  good(arguments + "-o b.exr --slice 2/2");
  good("merge b.exr a.exr -o merged.exr");
  EXPECT_LT(difference("whole.exr", "merged.exr"), 2e-7);
  good("render " + box_ + "--elements 700 --spp 8 --quiet --slice 2/2 -o other.exr");
  expect_error("merge a.exr other.exr -o c.exr",
               "other.exr: it was made from another radiosity solution than a.exr");
}

TEST_F(LongRender, MergeRefusesWhatDoesNotBelongTogether) {
  const std::string part = path_ + "--spp 8 --slice ";
  good(part + "1/2 -o a.exr");
  const struct {
    std::string arguments, message;
  } cases[] = {{part + "2/2 --seed 7 -o b.exr", "b.exr: its seed is 7, that of a.exr is 0"},
               {part + "2/2 --max-depth 4 -o b.exr", "its max depth is 4"},
               {sized("40x40", "direct") + "--spp 8 --slice 2/2 -o b.exr", "its integrator is direct"},
               {part + "2/2 --sampler independent -o b.exr", "its sampler is independent"},
               {sized("20x20") + "--spp 8 --slice 2/2 -o b.exr", "its size is 20x20"},
               {part + "2/2 --crop 0,0,20,20 -o b.exr", "its window is 20x20"},
               {part + "2/2 --clamp-indirect 3 -o b.exr", "its clamp of indirect light is 3"},
               {part + "2/2 --fov 20 -o b.exr", "its camera is "},
               {part + "1/2 -o b.exr", "b.exr: its samples 0 to 3 are in another of the parts, too"},
               {part + "1/4 -o b.exr", "its samples 0 to 1 are in another"},
               {path_ + "--spp 8 -o b.exr", "b.exr: it is a finished picture, not a partial one"}};
  for (const auto& c : cases) {
    good(c.arguments);
    expect_error("merge a.exr b.exr -o c.exr", c.message);
  }
  good("render '" TWOPASS_SOURCE_DIR
       "/scenes/cove/scene.xml' --size 40x40 --integrator path --spp 8 --quiet --slice 2/2 -o b.exr");
  expect_error("merge a.exr b.exr -o c.exr", "b.exr: it is a picture of another scene than a.exr");
  expect_error("merge a.exr nowhere.exr -o c.exr", "nowhere.exr");
  write("text.exr", "text");
  expect_error("merge a.exr text.exr -o c.exr", "text.exr: it is no OpenEXR file");
  expect_error("merge a.exr -o c.gif", ".exr, .png");
  EXPECT_FALSE(fs::exists(folder_ / "c.exr"));
  EXPECT_EQ(run("merge a.exr").exit_code, 2);
  EXPECT_EQ(run("merge -o a.exr").exit_code, 2);
}

TEST_F(LongRender, WhatCannotBeIsSaidAtOnce) {
  for (const char* slice : {"5/4", "1/0", "x", "1/4x", "1"})
    expect_error(path_ + "--spp 8 -o a.exr --slice " + slice, "K/N");
  expect_error(path_ + "--spp 8 -o a.exr --slice 1/9", "fewer than 9 slices");
  expect_error(path_ + "--noise .1 -o a.exr --slice 1/2", "--spp");
  expect_error(path_ + "-o a.exr --spp 8 --checkpoint a.png", ".exr");
  expect_error(path_ + "-o a.exr --spp 8 --checkpoint nowhere/a.exr", "nowhere");
  expect_error(path_ + "-o a.exr --spp 8 --resume nowhere.exr", "nowhere.exr");
  expect_error(path_ + "-o a.exr --spp 8 --preview localhost", "HOST:PORT");
  good(path_ + "--spp 4 -o p.png --checkpoint c.exr");
  expect_error(path_ + "-o a.exr --spp 8 --resume c.exr --seed 9",
               "c.exr: its seed is 0, that of this render is 9");
  good(path_ + "--spp 8 -o p.exr --slice 2/2");
  expect_error(path_ + "-o a.exr --spp 8 --resume p.exr", "it holds samples 4 to 7");
  EXPECT_FALSE(fs::exists(folder_ / "a.exr"));
}

TEST_F(LongRender, APictureThatNeedsMoreMemoryThanThereIsIsRefusedBeforePassOne) {
  const Outcome result =
      run("render '" + scene + "' --size 32768x32768 --spp 1 -o a.exr", "prlimit --as=4000000000");
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.err.find("32768x32768 pixels need"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("radiosity"), std::string::npos) << "no work was done: " << result.err;
}

TEST_F(LongRender, KilledAtAnyMomentItGoesOnWithTheSameBytes) {
  for (const std::vector<std::string>& goal : {std::vector<std::string>{"--spp", "200"}, {"--noise", "0.03"}}) {
    const std::string goal_text = goal[0] + " " + goal[1];
    for (const char* name : {"c.exr", "c.previous.exr"}) fs::remove(folder_ / name);
    good("render '" + scene + "' --size 64x64 --integrator path --quiet " + goal_text + " -o straight.exr");
    int killed = 0, code = 137;
    for (int i = 0; i < 40 && code == 137; ++i) {
      std::vector<std::string> more = goal;
      more.insert(more.end(),
                  {"--quiet", "-o", at("a.exr"), "--checkpoint", at("c.exr"), "--checkpoint-interval", "0.05"});
      if (fs::exists(folder_ / "c.exr")) more.insert(more.end(), {"--resume", at("c.exr")});
      RunningProgram program(slow(more));
      ASSERT_TRUE(appears("c.exr"));
      // Any moment, while a checkpoint is written, too.
      if (i < 6) {
        std::this_thread::sleep_for(std::chrono::milliseconds(150 + 37 * i));
        program.send(SIGKILL);
      }
      code = program.wait();
      killed += code == 137;
      for (const char* name : {"c.exr", "c.previous.exr"}) {
        if (fs::exists(folder_ / name)) {
          EXPECT_EQ(run("merge " + std::string(name) + " -o seen.exr --quiet").exit_code, 0) << name;
        }
      }
    }
    EXPECT_EQ(code, 0);
    EXPECT_GT(killed, 1);
    EXPECT_EQ(read(folder_ / "a.exr"), read(folder_ / "straight.exr")) << goal_text;
  }
}

TEST_F(LongRender, AFinishedRenderIsGivenMoreSamples) {
  good(path_ + "--spp 8 -o a.exr --checkpoint c.exr");
  good(path_ + "--spp 32 -o more.exr --resume c.exr");
  good(path_ + "--spp 32 -o straight.exr");
  EXPECT_LT(difference("more.exr", "straight.exr"), 2e-7);
  good(path_ + "--spp 8 -o same.exr --resume c.exr");
  EXPECT_EQ(read(folder_ / "same.exr"), read(folder_ / "a.exr")) << "nothing left to do";
  // A checkpoint is a part as well, and so is a merged one.
  good(path_ + "--spp 32 --slice 2/2 -o second.exr");
  good(path_ + "--spp 32 --slice 1/2 -o first.exr --resume c.exr");
  good("merge second.exr first.exr -o merged.exr --checkpoint all.exr");
  EXPECT_LT(difference("merged.exr", "straight.exr"), 2e-7);
  good(path_ + "--spp 64 -o a.exr --resume all.exr");
  good(path_ + "--spp 64 -o b.exr");
  EXPECT_LT(difference("a.exr", "b.exr"), 2e-7);
  good("merge second.exr --checkpoint all.exr");
  expect_error(path_ + "--spp 64 -o a.exr --resume all.exr", "samples 16 to 31");
}

TEST_F(LongRender, SignalsWriteWhatThereIs) {
  // A checkpoint says that it renders: only then are signals sent.
  const std::vector<std::string> goal{"--spp", "60000", "--checkpoint", at("c.exr"), "--checkpoint-interval",
                                      "0.1"};
  {
    std::vector<std::string> more = goal;
    more.insert(more.end(), {"-o", at("a.exr"), "-o", at("a.png")});
    RunningProgram program(slow(more), at("err"));
    ASSERT_TRUE(appears("c.exr"));
    program.send(SIGUSR1);
    ASSERT_TRUE(appears("a.png"));
    EXPECT_EQ(read_picture(folder_ / "a.exr").width, 64);
    const std::string first = read(folder_ / "a.exr");
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 143);
    EXPECT_NE(read(folder_ / "a.exr"), first) << "it went on";
    EXPECT_NE(read(folder_ / "err").find("SIGUSR1: wrote what there is"), std::string::npos);
    EXPECT_NE(read(folder_ / "err").find("interrupted: wrote what there was"), std::string::npos);
  }
  fs::remove(folder_ / "c.exr");
  {
    std::vector<std::string> more = goal;
    more.insert(more.end(), {"-o", at("part.exr"), "--slice", "2/2", "--quiet"});
    RunningProgram program(slow(more));
    ASSERT_TRUE(appears("c.exr"));
    program.send(SIGINT);
    EXPECT_EQ(program.wait(), 130);
    const Outcome merged = run("merge part.exr -o b.exr");
    EXPECT_EQ(merged.exit_code, 0) << merged.err;
    EXPECT_NE(merged.err.find("are in none of the parts"), std::string::npos) << merged.err;
  }
}

// A file system of its own for each test that needs one; only root may mount it.
class SmallDisk {
 public:
  SmallDisk(const fs::path& folder, const std::string& size) : folder_(folder) {
    fs::create_directories(folder);
    mounted_ = command("mount -t tmpfs -o size=" + size + " tmpfs");
  }
  ~SmallDisk() { detach(); }
  [[nodiscard]] bool is_mounted() const { return mounted_; }
  bool make_read_only() { return command("mount -o remount,ro"); }
  void detach() {
    if (mounted_) command("umount -l");
    mounted_ = false;
  }

 private:
  bool command(const std::string& text) const {
    return std::system((text + " '" + folder_.string() + "' 2>/dev/null").c_str()) == 0;
  }
  fs::path folder_;
  bool mounted_;
};

TEST_F(LongRender, AFullDiskEndsInOneErrorAndTheLastGoodFileIsIntact) {
  const SmallDisk disk(folder_ / "disk", "300k");
  if (!disk.is_mounted()) GTEST_SKIP() << "no small disk can be mounted here";
  // The checkpoint of 40x40 pixels takes about 220 kB: there is room for one, not for the next beside it.
  good(path_ + "--spp 4 -o a.exr --checkpoint disk/c.exr");
  const std::string before = read(folder_ / "disk/c.exr");
  expect_error(path_ + "--spp 8 -o b.exr --checkpoint disk/c.exr --resume disk/c.exr",
               "disk/c.exr: writing failed: No space left on device; free some space");
  EXPECT_EQ(read(folder_ / "disk/c.exr"), before);
  EXPECT_EQ(run("merge disk/c.exr -o seen.exr").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "b.exr")) << "what could be written has been";
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "disk"), fs::directory_iterator()), 1)
      << "no litter";
  // The same for pictures.
  good(sized("20x20") + "--spp 1 -o disk/p.exr");
  write("disk/filler", std::string(60000, 'x'));
  const std::string picture = read(folder_ / "disk/p.exr");
  const Outcome full =
      run("render '" + scene + "' --size 200x200 --integrator path --spp 1 --quiet -o disk/p.exr -o ok.png");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_NE(full.err.find("No space left"), std::string::npos) << full.err;
  EXPECT_EQ(read(folder_ / "disk/p.exr"), picture);
  EXPECT_TRUE(fs::exists(folder_ / "ok.png")) << "the other one is not lost";
}

TEST_F(LongRender, AFileThatMayNotGrowIsAnErrorToo) {
  good(path_ + "--spp 4 -o a.exr --checkpoint c.exr");
  const std::string before = read(folder_ / "c.exr");
  const std::string limited = "cd '" + folder_.string() + "' && ulimit -f 200 && '" TWOPASS_PROGRAM "' " +
                              path_ + "--spp 8 -o b.exr --checkpoint c.exr 2>err";
  EXPECT_EQ(WEXITSTATUS(std::system(("sh -c \"" + limited + "\"").c_str())), 1);
  const std::string err = read(folder_ / "err");
  EXPECT_NE(err.find("c.exr: writing failed: File too large; "), std::string::npos) << err;
  EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
  EXPECT_EQ(read(folder_ / "c.exr"), before);
}

TEST_F(LongRender, ADiskThatTurnsReadOnlyOrVanishesIsOneError) {
  for (const bool vanishes : {false, true}) {
    SmallDisk disk(folder_ / "disk", "4m");
    if (!disk.is_mounted()) GTEST_SKIP() << "no small disk can be mounted here";
    RunningProgram program(slow({"--spp", "60000", "--quiet", "-o", at("a.exr"), "--checkpoint",
                                 at("disk/c.exr"), "--checkpoint-interval", "0.1"}),
                           at("err"));
    ASSERT_TRUE(appears("disk/c.exr"));
    if (vanishes)
      disk.detach();
    else
      EXPECT_TRUE(disk.make_read_only());
    if (vanishes) fs::remove_all(folder_ / "disk");
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    program.send(SIGINT);
    EXPECT_EQ(program.wait(), 1);
    const std::string err = read(folder_ / "err");
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    EXPECT_NE(err.find("disk/c.exr: no file can be created there: "), std::string::npos) << err;
    EXPECT_EQ(read_picture(folder_ / "a.exr").width, 64) << "the picture is elsewhere, and is written";
    if (!vanishes) {
      EXPECT_EQ(run("merge disk/c.exr -o seen.exr").exit_code, 0);
    }
  }
}

// On a terminal, which `script` makes.
TEST_F(LongRender, ProgressOnATerminal) {
  if (std::system("command -v script >/dev/null") != 0) GTEST_SKIP() << "script is not installed";
  const std::string command =
      "cd '" + folder_.string() + "' && script -qec \"'" TWOPASS_PROGRAM "' render '" + scene +
      "' --size 100x100 --integrator path --spp 200 -o a.exr\" /dev/null </dev/null >log";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::string log = read(folder_ / "log");
  for (const char* part : {"rendering [#", " % ", " s left, pass ", " spp, noise 0.", " Mrays/s"})
    EXPECT_NE(log.find(part), std::string::npos) << part << '\n' << log;
  std::size_t longest = 0, begin = 0;
  for (std::size_t i = 0; i < log.size(); ++i)
    if (log[i] == '\r' || log[i] == '\n') {
      if (log.substr(begin, i - begin).find("rendering [") != std::string::npos)
        longest = std::max(longest, i - begin);
      begin = i + 1;
    }
  EXPECT_GT(longest, 0u);
  EXPECT_LT(longest, 80u + 3u) << "with the three bytes that erase a line";
}

TEST_F(LongRender, ThePreviewShowsThePictureOfTheFile) {
  test::Viewer viewer;
  good(sized("150x140") + "--spp 16 -o a.exr --preview " + viewer.address());
  const Image image = read_picture(folder_ / "a.exr");
  const auto shown = [&](const std::map<std::string, test::ViewedPicture>& all) {
    if (all.size() != 1 || !all.begin()->first.starts_with("a.exr (")) return false;
    const test::ViewedPicture& seen = all.begin()->second;
    if (seen.width != image.width || seen.height != image.height) return false;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (std::size_t c = 0; c < 4; ++c)
          if (seen.planes[c][static_cast<std::size_t>(y * image.width + x)] !=
              image.at(x, y, static_cast<int>(c)))
            return false;
    return true;
  };
  EXPECT_TRUE(viewer.wait(shown));
  EXPECT_EQ(viewer.error(), "");
}

}  // namespace
}  // namespace twopass
