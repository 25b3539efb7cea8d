// A robot for proofs: sends a keyframe every 1/30 s by the sender until its input ends, and prints the id of each that was acknowledged.
//
// It does so whatever the server does, until its queue is nearly full: then it stands still, and counts how often. An outage of 30 s does
// not fill the queue, but a server does that falls behind without an end, on a machine that is busy with other things.
//
// robot URL NAME           sends to map NAME until standard input ends; the last line has its figures
// robot URL NAME COUNT     sends the first COUNT again, and prints how many of them the server does not know as the same
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>

#include <revisit/revisit.hpp>

#include "samples.hpp"

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto period = 33'333us;
// Of the 1,920 places that keyframes have.
constexpr std::size_t most_queued = 1'800;
// A busy machine may take long for all of it. That nothing at all was sent for so long is a fault.
constexpr auto longest_standstill = 300s;

/// The number decides everything, so that it can be made again.
static revisit::Keyframe keyframe(const std::string& robot, unsigned number) {
    auto keyframe = samples::keyframe(number, 100, 100, 30);
    keyframe.id = robot + "-" + std::to_string(number);
    keyframe.session = robot;
    keyframe.detections = samples::plate("", number * 0.1, 0, std::to_string(100 + number)).detections;
    return keyframe;
}

static int send_again(const std::string& url, const std::string& robot, unsigned count) {
    revisit::Endpoint endpoint;
    endpoint.url = url;
    auto client = revisit::Client::open(endpoint);
    unsigned changed = 0;
    for (unsigned number = 0; client && number < count; ++number) {
        const auto answer = client->put_keyframe(robot, keyframe(robot, number));
        changed += answer && answer->is_replayed ? 0 : 1;
    }
    std::printf("changed %u\n", client ? changed : count);
    return 0;
}

/// Waits until all is sent, for as long as something is.
static bool is_flushed(revisit::Sender& sender) {
    while (true) {
        const auto before = sender.stats().sent;
        if (sender.flush(longest_standstill)) return true;
        if (sender.stats().sent == before) return false;
    }
}

int main(int count, char** arguments) {
    if (count < 3) return 2;
    const std::string url = arguments[1], robot = arguments[2];
    if (count > 3) return send_again(url, robot, static_cast<unsigned>(std::atoi(arguments[3])));
    revisit::SenderOptions options;
    options.endpoint.url = url;
    options.map = robot;
    // A server that was killed is noticed at once. One that takes long is on a busy machine, and not away.
    options.endpoint.timeout_ms = 120'000;
    options.on_outcome = [](const revisit::Outcome& outcome) {
        if (outcome.kind != revisit::Outcome::Kind::keyframe) return;
        std::printf("%s %s\n", outcome.ok() ? "acknowledged" : "refused", outcome.id.c_str());
        std::fflush(stdout);
    };
    auto sender = revisit::Sender::open(options);
    if (!sender) return 1;
    std::atomic<bool> stopping{false};
    std::thread input([&] {
        char byte;
        while (read(0, &byte, 1) > 0) {
        }
        stopping = true;
    });
    double longest_ms = 0, furthest_behind_s = 0;
    unsigned put = 0, stood_still = 0;
    std::size_t longest_queue = 0;
    auto due = Clock::now();
    while (!stopping) {
        std::this_thread::sleep_until(due += period);
        const auto now = (*sender)->stats();
        furthest_behind_s = std::max(furthest_behind_s, now.lag_s);
        longest_queue = std::max(longest_queue, now.queued);
        if (now.queued >= most_queued) {
            ++stood_still;
            continue;
        }
        auto made = keyframe(robot, put++);
        const auto begun = Clock::now();
        (void)(*sender)->send(std::move(made));
        longest_ms = std::max(longest_ms, std::chrono::duration<double, std::milli>(Clock::now() - begun).count());
    }
    input.join();
    const bool is_all_sent = is_flushed(**sender);
    const auto stats = (*sender)->stats();
    std::printf("put %u sent %llu refused %llu dropped %llu retries %llu longest_ms %.3f behind_s %.1f queue %zu stood_still %u\n", put, static_cast<unsigned long long>(stats.sent),
                static_cast<unsigned long long>(stats.refused), static_cast<unsigned long long>(stats.dropped), static_cast<unsigned long long>(stats.retries), longest_ms, furthest_behind_s, longest_queue, stood_still);
    return is_all_sent ? 0 : 1;
}
