// The program as a user runs it: in a folder of its own, with its exit code and what it says.
#pragma once

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace twopass {

inline bool is_installed(const std::string& tool) {
  return std::system(("command -v " + tool + " >/dev/null 2>&1").c_str()) == 0;
}

struct Outcome {
  int exit_code;
  std::string out, err;
};

class Program : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("twopass-program-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // Arguments are given as the shell takes them; `environment` stands before the program.
  Outcome run(const std::string& arguments, const std::string& environment = "") const {
    const std::filesystem::path out = folder_ / "stdout", err = folder_ / "stderr";
    const std::string command = "cd '" + folder_.string() + "' && env " + environment +
                                " '" TWOPASS_PROGRAM "' " + arguments + " >'" + out.string() + "' 2>'" +
                                err.string() + "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read(out), read(err)};
  }
  static std::string read(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  std::filesystem::path folder_;
  const std::string box_ = "'" TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml' --size 40x40 ";
};

// The program on its own, for signals. Killed when destroyed.
class RunningProgram {
 public:
  // Its stderr goes to the file `err`, if that has a name.
  explicit RunningProgram(const std::vector<std::string>& arguments, const std::string& err = "") {
    std::vector<std::string> all{"twopass"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& argument : all) argv.push_back(argument.data());
    argv.push_back(nullptr);
    child_ = fork();
    if (child_ == 0) {
      const int to = err.empty() ? -1 : open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
      if (to >= 0) dup2(to, STDERR_FILENO);
      execv(TWOPASS_PROGRAM, argv.data());
      _exit(99);
    }
  }
  ~RunningProgram() {
    if (child_ <= 0) return;
    send(SIGKILL);
    wait();
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void send(int signal) const { kill(child_, signal); }
  // Its exit code; 128 and the signal that killed it.
  int wait() {
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t child_ = 0;
};

}  // namespace twopass
