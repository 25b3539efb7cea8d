// A stand-in for a server: answers by a function, or never.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <zstd.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <list>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "check.hpp"

struct HeardRequest {
    std::string method;
    std::string target;
    std::string headers;
    /// Decompressed.
    std::string body;
};

struct GivenAnswer {
    int status = 200;
    std::string body = "{}";
    std::string headers;
    /// Hold the request without an answer until the stand-in ends.
    bool never = false;
    /// Close the connection instead of answering.
    bool cut = false;
};

class StandIn {
public:
    using Handler = std::function<GivenAnswer(const HeardRequest&)>;

    explicit StandIn(Handler handler, int port = 0) : handler_(std::move(handler)) {
        listener_ = socket(AF_INET, SOCK_STREAM, 0);
        int yes = 1;
        setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(static_cast<std::uint16_t>(port));
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        CHECK(bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
        CHECK(listen(listener_, 64) == 0);
        socklen_t size = sizeof address;
        getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
        port_ = ntohs(address.sin_port);
        acceptor_ = std::thread([this] { accept_all(); });
    }

    ~StandIn() {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            ending_ = true;
            for (const int one : open_) shutdown(one, SHUT_RDWR);
        }
        changed_.notify_all();
        shutdown(listener_, SHUT_RDWR);
        acceptor_.join();
        for (auto& thread : threads_) thread.join();
        close(listener_);
    }

    int port() const { return port_; }
    std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

    std::vector<HeardRequest> heard() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return heard_;
    }

    /// Waits until so many requests have arrived; ctest's own limit ends a test in which they never do.
    void wait_for(std::size_t count) {
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, [&] { return heard_.size() >= count; });
    }

private:
    void accept_all() {
        while (true) {
            const int connection = accept(listener_, nullptr, nullptr);
            const std::lock_guard<std::mutex> lock(mutex_);
            if (ending_ || connection < 0) {
                if (connection >= 0) close(connection);
                return;
            }
            open_.insert(connection);
            threads_.emplace_back([this, connection] { serve(connection); });
        }
    }

    void serve(int connection) {
        std::string data;
        while (one(connection, data)) {
        }
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            open_.erase(connection);
        }
        close(connection);
    }

    static bool read_more(int connection, std::string& data) {
        char chunk[65536];
        const auto count = recv(connection, chunk, sizeof chunk, 0);
        if (count <= 0) return false;
        data.append(chunk, static_cast<std::size_t>(count));
        return true;
    }

    bool one(int connection, std::string& data) {
        std::size_t end;
        while ((end = data.find("\r\n\r\n")) == std::string::npos)
            if (!read_more(connection, data)) return false;
        HeardRequest request;
        request.headers = data.substr(0, end + 2);
        const auto first = request.headers.find(' '), second = request.headers.find(' ', first + 1);
        request.method = request.headers.substr(0, first);
        request.target = request.headers.substr(first + 1, second - first - 1);
        std::string lower = request.headers;
        for (auto& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        std::size_t length = 0;
        if (const auto at = lower.find("content-length: "); at != std::string::npos) length = std::strtoul(lower.c_str() + at + 16, nullptr, 10);
        while (data.size() < end + 4 + length)
            if (!read_more(connection, data)) return false;
        request.body = data.substr(end + 4, length);
        data.erase(0, end + 4 + length);
        if (lower.find("content-encoding: zstd") != std::string::npos) {
            std::string plain(ZSTD_getFrameContentSize(request.body.data(), request.body.size()), '\0');
            CHECK(ZSTD_decompress(plain.data(), plain.size(), request.body.data(), request.body.size()) == plain.size());
            request.body = std::move(plain);
        }
        const GivenAnswer answer = handler_(request);
        {
            std::unique_lock<std::mutex> lock(mutex_);
            heard_.push_back(std::move(request));
            changed_.notify_all();
            if (answer.never) {
                changed_.wait(lock, [&] { return ending_; });
                return false;
            }
        }
        if (answer.cut) return false;
        const std::string text = "HTTP/1.1 " + std::to_string(answer.status) + " Any\r\ncontent-type: application/json\r\ncontent-length: " +
                                 std::to_string(answer.body.size()) + "\r\n" + answer.headers + "\r\n" + answer.body;
        return send(connection, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
    }

    Handler handler_;
    int listener_ = -1;
    int port_ = 0;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<HeardRequest> heard_;
    std::set<int> open_;
    bool ending_ = false;
    std::list<std::thread> threads_;
    std::thread acceptor_;
};
