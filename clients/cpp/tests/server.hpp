// The real server, $REVISIT_BINARY, on a database of its own.
#pragma once

#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "check.hpp"

extern char** environ;

class Server {
public:
    Server() {
        char name[] = "/tmp/revisit-cpp-XXXXXX";
        CHECK(mkdtemp(name) != nullptr);
        folder_ = name;
        start();
    }

    ~Server() {
        kill_now();
        std::filesystem::remove_all(folder_);
    }

    const std::string& url() const { return url_; }

    /// Kills it as a crash would.
    void kill_now() {
        if (process_ == 0) return;
        ::kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
        process_ = 0;
    }

    /// Starts it again at the same address.
    void start() {
        const char* binary = std::getenv("REVISIT_BINARY");
        if (binary == nullptr) checks::fail(__FILE__, __LINE__, "REVISIT_BINARY names no program");
        int out[2];
        CHECK(pipe(out) == 0);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, out[1], 1);
        posix_spawn_file_actions_addclose(&actions, out[0]);
        const std::string database = "sqlite://" + folder_ + "/revisit.db";
        std::string arguments[] = {binary, "serve", "--listen", listen_, "--database", database, "--log", "error"};
        char* pointers[9] = {};
        for (int i = 0; i < 8; ++i) pointers[i] = arguments[i].data();
        CHECK(posix_spawn(&process_, binary, &actions, nullptr, pointers, environ) == 0);
        posix_spawn_file_actions_destroy(&actions);
        close(out[1]);
        std::string line;
        char c;
        while (read(out[0], &c, 1) == 1 && c != '\n') line += c;
        close(out[0]);
        const auto at = line.find("http://");
        if (at == std::string::npos) checks::fail(__FILE__, __LINE__, "the server said: " + line);
        url_ = line.substr(at);
        listen_ = url_.substr(7);
    }

private:
    std::string folder_;
    std::string url_;
    std::string listen_ = "127.0.0.1:0";
    pid_t process_ = 0;
};
