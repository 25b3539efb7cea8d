// Options of a sender, and its reports: outcomes and counts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "client.hpp"

namespace revisit {

/// What was sent, or could not be.
struct Outcome {
    enum class Kind { keyframe, question, poses, observations, merge, confirmation, revocation, removal, map };
    Kind kind = Kind::keyframe;
    /// The keyframe's, the loop's, or the session's id.
    std::string id;
    /// HTTP status, 0 where the server never answered.
    int status = 0;
    /// Its code is `ok` after success.
    Error error{Code::ok};
    Json answer;

    bool ok() const noexcept { return error.code == Code::ok; }
};

struct SenderOptions {
    Endpoint endpoint;
    std::string map;
    /// Makes the map with default settings if it does not exist.
    bool makes_map = true;
    /// Bounds of the queue. 30 keyframes a second fill it in 68 s, at 70 KB each with 150 MB.
    std::size_t queue_items = 2048;
    std::size_t queue_bytes = std::size_t{256} << 20;
    /// Items and bytes of the queue that keyframes may not take, so that a full queue still takes poses and loops.
    std::size_t reserved_items = 128;
    std::size_t reserved_bytes = std::size_t{32} << 20;
    /// Waits between tries: doubled from the first to the longest, half of each random.
    int first_wait_ms = 100;
    int longest_wait_ms = 2'000;
    /// Tries of an item that the server answers with 500. Other failures of a server are retried without an end.
    int tries_of_a_fault = 5;
    /// How long the destructor goes on sending before it drops what is left.
    int closing_ms = 2'000;
    Precision precision;

    // All in the sender's thread, except that `on_dropped` may also be in the thread of a refused call.
    // What they throw is counted and goes no further.
    std::function<void(const Verdict&)> on_verdict;
    std::function<void(const Outcome&)> on_outcome;
    /// What will never be sent: refused because the queue is full, or left when the sender closed.
    std::function<void(const Outcome&)> on_dropped;
};

struct SenderStats {
    std::size_t queued = 0;
    std::size_t queued_bytes = 0;
    std::uint64_t sent = 0;
    /// Answered with a problem that a retry does not mend.
    std::uint64_t refused = 0;
    std::uint64_t dropped = 0;
    std::uint64_t retries = 0;
    std::uint64_t callback_faults = 0;
    /// Age of the oldest item that is not sent.
    double lag_s = 0;
    /// Whether the last try found no server, or one that is overloaded.
    bool unreachable = false;
};

}  // namespace revisit
