// Sender: takes what a robot sends without ever waiting for the server, and sends it in order in the background.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <iterator>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "background_thread.hpp"
#include "client.hpp"
#include "missing_keyframes.hpp"
#include "sender_options.hpp"

namespace revisit {

/// A bounded queue before a server, emptied by one thread in the order of the calls.
///
/// A call checks, copies and enqueues. The lock that it takes is never held during input, output, encoding or a callback.
/// A full queue refuses the new item: the call returns `queue_full`, and `on_dropped` is called.
/// Corrections and observations leave out keyframes that the server does not have, since it would refuse all of it.
class Sender {
public:
    static Result<std::unique_ptr<Sender>> open(SenderOptions options) noexcept {
        return detail::guarded([&]() -> Result<std::unique_ptr<Sender>> {
            detail::Checker checker;
            if (!checker.id(options.map, "/map")) return checker.status().error();
            if (options.queue_items <= options.reserved_items || options.queue_bytes <= options.reserved_bytes)
                return Error(Code::invalid, "/queue_items", "the queue is smaller than what is reserved of it");
            auto connection = detail::Connection::open(options.endpoint);
            if (!connection) return connection.error();
            std::unique_ptr<Sender> sender(new Sender(std::move(options), std::move(*connection)));
            sender->thread_ = std::thread([raw = sender.get()] { raw->run(); });
            return sender;
        });
    }

    Sender(const Sender&) = delete;
    Sender& operator=(const Sender&) = delete;
    ~Sender() { close(std::chrono::milliseconds(options_.closing_ms)); }

    /// Sends a keyframe; with a question, its verdict goes to `on_verdict`.
    Status send(Keyframe keyframe, std::optional<Question> question = std::nullopt) noexcept {
        if (auto status = check(keyframe); !status) return status;
        return enqueue(Outcome::Kind::keyframe, [&](Item& item) {
            item.bytes = bytes_of(keyframe);
            item.id = keyframe.id;
            item.question = question;
            item.payload = std::move(keyframe);
        });
    }

    /// Asks about a keyframe that was sent before.
    Status ask(const std::string& keyframe, const Question& question = Question()) noexcept {
        if (auto status = id_status(keyframe, "/keyframe"); !status) return status;
        return enqueue(Outcome::Kind::question, [&](Item& item) {
            item.id = keyframe;
            item.question = question;
        });
    }

    Status correct(PoseCorrections corrections) noexcept {
        if (auto status = check(corrections); !status) return status;
        return enqueue(Outcome::Kind::poses, [&](Item& item) {
            item.id = corrections.session;
            item.bytes = corrections.poses.size() * (sizeof(Pose) + sizeof(std::string) + 16) + corrections.map_points.ids.size() * 32;
            item.payload = std::move(corrections);
        });
    }

    Status update(Observations observations) noexcept {
        if (auto status = check(observations); !status) return status;
        return enqueue(Outcome::Kind::observations, [&](Item& item) {
            item.id = observations.session;
            item.bytes = observations.replaced.size() * 16 + observations.removed.size() * 8;
            for (const auto& keyframe : observations.keyframes)
                item.bytes += sizeof keyframe + (keyframe.observes ? keyframe.observes->size() * 8 : 0) + (keyframe.covisible ? keyframe.covisible->size() * sizeof(Covisible) : 0);
            item.payload = std::move(observations);
        });
    }

    Status merge(SessionMerge merge) noexcept {
        if (auto status = check(merge); !status) return status;
        return enqueue(Outcome::Kind::merge, [&](Item& item) {
            item.id = merge.session;
            item.bytes = merge.points.size() * 16;
            item.payload = std::move(merge);
        });
    }

    /// States that the host has closed a loop.
    Status confirm(Loop loop) noexcept {
        if (auto status = check(loop); !status) return status;
        return enqueue(Outcome::Kind::confirmation, [&](Item& item) {
            item.id = loop.id;
            item.payload = std::move(loop);
        });
    }

    /// Takes back a confirmed loop.
    Status revoke(const std::string& loop) noexcept {
        if (auto status = id_status(loop, "/loop"); !status) return status;
        return enqueue(Outcome::Kind::revocation, [&](Item& item) { item.id = loop; });
    }

    /// Removes a keyframe that the host has culled.
    Status remove(const std::string& keyframe) noexcept {
        if (auto status = id_status(keyframe, "/keyframe"); !status) return status;
        return enqueue(Outcome::Kind::removal, [&](Item& item) { item.id = keyframe; });
    }

    SenderStats stats() const noexcept {
        const std::lock_guard<std::mutex> lock(mutex_);
        SenderStats stats = stats_;
        stats.queued = queue_.size() + flying_count_;
        stats.queued_bytes = bytes_;
        const auto oldest = flying_since_ ? flying_since_ : queue_.empty() ? std::nullopt : std::optional(queue_.front().since);
        if (oldest) stats.lag_s = std::chrono::duration<double>(Clock::now() - *oldest).count();
        return stats;
    }

    /// Waits until all is sent; whether it was, within the time.
    bool flush(std::chrono::milliseconds timeout) noexcept {
        std::unique_lock<std::mutex> lock(mutex_);
        return changed_.wait_for(lock, timeout, [&] { return queue_.empty() && !flying_since_; });
    }

    /// Sends for at most `timeout` more, then drops the rest; returns how many were dropped. Not to be called from a callback.
    std::size_t close(std::chrono::milliseconds timeout) noexcept {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            closing_ = true;
        }
        flush(timeout);
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            abandoned_.store(true);
        }
        arrived_.notify_all();
        changed_.notify_all();
        if (!thread_.joinable()) return 0;
        thread_.join();
        std::list<Item> left;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            left.swap(queue_);
            stats_.dropped += left.size();
            bytes_ = 0;
        }
        for (const auto& item : left) report_dropped(item.kind, item.id, Code::abandoned);
        return left.size();
    }

private:
    using Clock = std::chrono::steady_clock;

    struct Item {
        Outcome::Kind kind = Outcome::Kind::keyframe;
        std::string id;
        std::variant<std::monostate, Keyframe, PoseCorrections, Observations, SessionMerge, Loop> payload;
        std::optional<Question> question;
        Clock::time_point since;
        std::size_t bytes = 0;
    };

    // A conflict: the keyframe is there, as it was sent first.
    static constexpr int stored_otherwise = 409;
    // Keyframes of one request: enough to catch up after an outage, few enough to be sent again.
    static constexpr std::size_t max_batch = 64;
    static constexpr std::size_t max_batch_bytes = std::size_t{4} << 20;

    Sender(SenderOptions options, std::unique_ptr<detail::Connection> connection)
        : options_(std::move(options)), connection_(std::move(connection)), random_(std::random_device{}()) {}

    static std::size_t bytes_of(const Keyframe& keyframe) noexcept {
        std::size_t bytes = keyframe.features.descriptors.size() + keyframe.features.keypoints.size() * sizeof(Keypoint) + keyframe.features.map_points.size() * 8 +
                            keyframe.bow.words.size() * 12 + keyframe.map_points.ids.size() * 32 + keyframe.observes.size() * 8 +
                            (keyframe.covisible ? keyframe.covisible->size() * sizeof(Covisible) : 0);
        for (const auto& detection : keyframe.detections)
            bytes += sizeof detection + detection.crop.size() + detection.text.size() + detection.description.size() + detection.map_points.size() * 8;
        return bytes;
    }

    static Status id_status(const std::string& id, const char* field) noexcept {
        return detail::guarded([&]() -> Status {
            detail::Checker checker;
            checker.id(id, field);
            return checker.status();
        });
    }

    template <class F>
    Status enqueue(Outcome::Kind kind, F&& fill) noexcept {
        return detail::guarded([&]() -> Status {
            // Built before the lock is taken; under it a node is only linked.
            std::list<Item> one(1);
            Item& item = one.front();
            item.kind = kind;
            fill(item);
            item.bytes += sizeof(Item) + item.id.size();
            item.since = Clock::now();
            const bool is_keyframe = kind == Outcome::Kind::keyframe || kind == Outcome::Kind::question;
            const std::size_t items = options_.queue_items - (is_keyframe ? options_.reserved_items : 0);
            const std::size_t bytes = options_.queue_bytes - (is_keyframe ? options_.reserved_bytes : 0);
            Code refused = Code::ok;
            bool wakes = false;
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                if (closing_) {
                    refused = Code::closed;
                } else if (queue_.size() >= items || bytes_ + item.bytes > bytes) {
                    refused = Code::queue_full;
                } else {
                    bytes_ += item.bytes;
                    queue_.splice(queue_.end(), one);
                    wakes = is_idle_;
                }
                if (refused != Code::ok) ++stats_.dropped;
            }
            if (refused == Code::ok) {
                // Not while it waits for a server that is away: each waking may cost the caller its processor.
                if (wakes) arrived_.notify_one();
                return Status();
            }
            if (kind == Outcome::Kind::keyframe) missing_.note(item.id);
            report_dropped(kind, item.id, refused);
            return Error(refused, refused == Code::closed ? "the sender is closed" : "the queue is full; the server is unreachable or too slow");
        });
    }

    template <class... Arguments>
    void notify(const std::function<void(Arguments...)>& callback, Arguments... arguments) noexcept {
        if (!callback) return;
        try {
            callback(arguments...);
        } catch (...) {
            const std::lock_guard<std::mutex> lock(mutex_);
            ++stats_.callback_faults;
        }
    }

    void report_dropped(Outcome::Kind kind, const std::string& id, Code code) noexcept {
        if (!options_.on_dropped) return;
        Outcome outcome;
        outcome.kind = kind;
        outcome.error = Error(code);
        try {
            outcome.id = id;
        } catch (...) {
            // Without memory for its id it is reported all the same.
        }
        notify<const Outcome&>(options_.on_dropped, outcome);
    }

    void run() noexcept {
        detail::yield_to_callers();
        bool map_is_there = !options_.makes_map;
        while (true) {
            std::list<Item> flying;
            {
                std::unique_lock<std::mutex> lock(mutex_);
                is_idle_ = true;
                arrived_.wait(lock, [&] { return abandoned_.load() || !queue_.empty(); });
                is_idle_ = false;
                if (abandoned_.load()) return;
                take_batch(flying);
                flying_since_ = flying.front().since;
                flying_count_ = flying.size();
            }
            bool is_done = true;
            if (!map_is_there) {
                is_done = make_map();
                map_is_there = is_done;
            }
            if (is_done) is_done = flying.size() > 1 ? carry_out_batch(flying) : carry_out_each(flying);
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                flying_since_.reset();
                flying_count_ = 0;
                // Closing: back in front, where `close` finds and reports them.
                queue_.splice(queue_.begin(), flying);
            }
            changed_.notify_all();
            if (!is_done) return;
        }
    }

    /// Moves the oldest item out of the queue, with the keyframes behind it that can share its request.
    void take_batch(std::list<Item>& flying) noexcept {
        std::size_t bytes = 0;
        do {
            bytes += queue_.front().bytes;
            flying.splice(flying.end(), queue_, queue_.begin());
        } while (can_be_batched(flying.back()) && !queue_.empty() && can_be_batched(queue_.front()) && flying.size() < batch_limit_ && bytes + queue_.front().bytes <= max_batch_bytes);
    }

    /// Whether a keyframe may share a request: a question has its own, and declared edges may name one that the same batch loses.
    static bool can_be_batched(const Item& item) noexcept {
        if (item.kind != Outcome::Kind::keyframe || item.question) return false;
        const auto& listed = std::get<Keyframe>(item.payload).covisible;
        return !listed || listed->empty();
    }

    /// Forgets an item that is settled.
    void settle(std::list<Item>& flying, std::list<Item>::iterator item) noexcept {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            bytes_ -= item->bytes;
            --flying_count_;
        }
        flying.erase(item);
    }

    bool carry_out_each(std::list<Item>& flying) noexcept {
        while (!flying.empty()) {
            if (!carry_out(flying.front())) return false;
            settle(flying, flying.begin());
        }
        return true;
    }

    /// Sends keyframes in one request: a backlog costs one sync of the server's disk for each batch, not for each keyframe.
    /// What the server could not store at this moment is sent again by itself. A server that does not get through with a batch in time
    /// gets half of it: the same one again would never end. False if the sender is closing.
    bool carry_out_batch(std::list<Item>& flying) noexcept {
        Call call;
        const Status prepared = detail::guarded([&]() -> Status {
            call.path.emplace_back("map", options_.map);
            for (const Item& item : flying) {
                std::string line = "{\"id\":";
                detail::append_string(line, item.id);
                std::string body;
                detail::append_keyframe(body, std::get<Keyframe>(item.payload), options_.precision);
                // A body is never empty: its first member follows.
                line += ',';
                call.body += line.append(body, 1) += '\n';
            }
            return Status();
        });
        if (!prepared) return carry_out_each(flying);
        auto answer = deliver("put_keyframes", std::move(call), true);
        if (!answer) return false;
        if (!*answer && answer->error().is_timeout) {
            halve(flying);
            return flying.size() > 1 ? carry_out_batch(flying) : carry_out_each(flying);
        }
        if (!*answer) return carry_out_each(flying);
        batch_limit_ = std::min(2 * batch_limit_, max_batch);
        const std::string& text = (**answer).text;
        auto item = flying.begin();
        for (std::size_t at = 0; at < text.size() && item != flying.end();) {
            const std::size_t end = std::min(text.find('\n', at), text.size());
            auto line = Json::parse(std::string_view(text).substr(at, end - at));
            at = end + 1;
            const auto current = item++;
            if (!line || (*line)["id"].text() != current->id) break;
            const auto status = static_cast<int>((*line)["status"].integer());
            if (status == 429 || status >= 500) continue;
            auto outcome = outcome_of(status, std::move(*line));
            note_presence(current->id, outcome.ok() || status == stored_otherwise);
            finish(current->kind, current->id, std::move(outcome));
            settle(flying, current);
        }
        return carry_out_each(flying);
    }

    /// Puts the younger half of a batch back, and takes no larger ones until one was answered.
    void halve(std::list<Item>& flying) noexcept {
        batch_limit_ = std::max<std::size_t>(flying.size() / 2, 1);
        const std::lock_guard<std::mutex> lock(mutex_);
        queue_.splice(queue_.begin(), flying, std::next(flying.begin(), static_cast<std::ptrdiff_t>(batch_limit_)), flying.end());
        flying_count_ = flying.size();
    }

    /// Notes whether the server has a keyframe.
    void note_presence(const std::string& id, bool is_there) noexcept {
        (void)detail::guarded([&]() -> Status {
            if (is_there) missing_.clear(id);
            else missing_.note(id);
            return Status();
        });
    }

    /// The result of one line of a batch.
    static Result<Answer> outcome_of(int status, Json line) noexcept {
        return detail::guarded([&]() -> Result<Answer> {
            if (status >= 400) {
                std::string problem;
                line["problem"].write(problem);
                return detail::answer_of({status, std::move(problem), -1, false});
            }
            return Answer{status, std::move(line), {}, status == 200};
        });
    }

    /// Makes the map; whether the sender goes on.
    bool make_map() noexcept {
        Call call;
        bool made = false;
        auto prepared = detail::guarded([&]() -> Status {
            call.path.emplace_back("map", options_.map);
            call.body = "{}";
            made = true;
            return Status();
        });
        if (!made) return true;
        auto answer = deliver("put_map", std::move(call));
        if (!answer) return false;
        // A map with settings of its own is as good: 409. Without the right to make one, the keyframe says whether it is there.
        if (!*answer && answer->error().status != 409 && answer->error().status != 403) finish(Outcome::Kind::map, options_.map, std::move(*answer));
        return true;
    }

    /// Sends an item until it is answered; false if the sender is closing.
    bool carry_out(Item& item) noexcept {
        std::string operation;
        Call call;
        bool is_nothing_left = false;
        const Status prepared = detail::guarded([&]() -> Status {
            prepare(item, operation, call, is_nothing_left);
            return Status();
        });
        if (is_nothing_left) return true;
        if (!prepared) {
            finish(item.kind, item.id, prepared.error());
            return true;
        }
        auto answer = deliver(operation, std::move(call));
        if (!answer) return false;
        const bool is_stored = answer->ok();
        if (item.kind == Outcome::Kind::keyframe) note_presence(item.id, is_stored || answer->error().status == stored_otherwise);
        // Another thread of the host may name it in what it sends after.
        if (item.kind == Outcome::Kind::removal && is_stored) note_presence(item.id, false);
        const bool asks_next = is_stored && item.kind == Outcome::Kind::keyframe && item.question && !item.question->is_plain();
        const bool has_verdict = is_stored && item.question && !asks_next;
        Json verdict;
        if (has_verdict) {
            // The outcome keeps the whole answer; the verdict is a copy of its part.
            (void)detail::guarded([&]() -> Status {
                verdict = item.kind == Outcome::Kind::keyframe ? (**answer).json["loop"] : (**answer).json;
                return Status();
            });
        }
        finish(item.kind, item.id, std::move(*answer));
        if (has_verdict) report_verdict(item.id, std::move(verdict));
        if (!asks_next) return true;
        return ask_now(item);
    }

    /// Asks a question that a keyframe's own request cannot; false if the sender is closing.
    bool ask_now(const Item& item) noexcept {
        std::string operation;
        Call call;
        const Status prepared = detail::guarded([&]() -> Status {
            prepare_question(item, operation, call);
            return Status();
        });
        if (!prepared) {
            finish(Outcome::Kind::question, item.id, prepared.error());
            return true;
        }
        auto answer = deliver(operation, std::move(call));
        if (!answer) return false;
        Json verdict;
        const bool is_answered = answer->ok();
        if (is_answered) verdict = std::move((**answer).json);
        finish(Outcome::Kind::question, item.id, std::move(*answer));
        if (is_answered) report_verdict(item.id, std::move(verdict));
        return true;
    }

    void prepare_question(const Item& item, std::string& operation, Call& call) {
        operation = "query_loop";
        call.path = {{"map", options_.map}};
        if (item.question->brief) call.query.emplace_back("detail", "brief");
        call.body = detail::question_body(item.id, *item.question);
    }

    void prepare(Item& item, std::string& operation, Call& call, bool& is_nothing_left) {
        call.path = {{"map", options_.map}};
        switch (item.kind) {
            case Outcome::Kind::keyframe: {
                operation = "put_keyframe";
                call.path.emplace_back("keyframe", item.id);
                if (item.question && item.question->is_plain()) {
                    call.query.emplace_back("query", "loop");
                    if (item.question->brief) call.query.emplace_back("detail", "brief");
                }
                auto& keyframe = std::get<Keyframe>(item.payload);
                if (keyframe.covisible) missing_.leave_out_of(*keyframe.covisible);
                detail::append_keyframe(call.body, keyframe, options_.precision);
                break;
            }
            case Outcome::Kind::question: prepare_question(item, operation, call); break;
            case Outcome::Kind::poses: {
                operation = "correct_poses";
                auto& corrections = std::get<PoseCorrections>(item.payload);
                missing_.leave_out_of(corrections);
                is_nothing_left = corrections.keyframes.empty() && corrections.map_points.ids.empty();
                call.body = detail::body_of(corrections, options_.precision);
                break;
            }
            case Outcome::Kind::observations: {
                operation = "change_observations";
                auto& observations = std::get<Observations>(item.payload);
                missing_.leave_out_of(observations);
                is_nothing_left = observations.keyframes.empty() && observations.replaced.empty() && observations.removed.empty();
                call.body = detail::body_of(observations);
                break;
            }
            case Outcome::Kind::merge:
                operation = "merge_sessions";
                call.path.emplace_back("session", item.id);
                call.body = detail::body_of(std::get<SessionMerge>(item.payload));
                break;
            case Outcome::Kind::confirmation:
                operation = "confirm_loop";
                call.body = detail::body_of(std::get<Loop>(item.payload));
                break;
            case Outcome::Kind::revocation:
                operation = "revoke_loop";
                call.path.emplace_back("loop", item.id);
                break;
            case Outcome::Kind::removal:
                operation = "delete_keyframe";
                call.path.emplace_back("keyframe", item.id);
                break;
            case Outcome::Kind::map: break;
        }
    }

    /// Tries until the server has decided, or `ends_at_timeout`; nothing if the sender is closing.
    std::optional<Result<Answer>> deliver(const std::string& operation, Call call, bool ends_at_timeout = false) noexcept {
        Result<detail::Request> request = detail::guarded([&]() -> Result<detail::Request> { return detail::request_of(operation, std::move(call)); });
        if (!request) return Result<Answer>(request.error());
        bool is_compressed = false;
        (void)detail::guarded([&]() -> Status { return is_compressed = detail::compress(request->body), Status(); });
        int faults = 0;
        for (int attempt = 0;; ++attempt) {
            Result<Answer> answer = detail::guarded([&]() -> Result<Answer> {
                auto response = connection_->send(*request, is_compressed, &abandoned_);
                if (!response) return response.error();
                return detail::answer_of(std::move(*response));
            });
            const bool again = !answer && is_retried(answer.error(), faults);
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                stats_.unreachable = again;
                if (again) ++stats_.retries;
            }
            // The first try removed it, and its answer was lost.
            const bool was_removed = !answer && attempt > 0 && request->method == "DELETE" && answer.error().status == 404;
            if (was_removed) return Result<Answer>(Answer{404, {}, {}, true});
            if (!again || (ends_at_timeout && answer.error().is_timeout)) return answer;
            if (!wait(attempt, answer.error().retry_after_s)) return std::nullopt;
        }
    }

    bool is_retried(const Error& error, int& faults) const noexcept {
        switch (error.code) {
            case Code::unreachable:
            case Code::abandoned:
            case Code::out_of_memory: return true;
            case Code::problem: break;
            // A proxy's page, most likely.
            case Code::malformed_answer: return ++faults < options_.tries_of_a_fault;
            default: return false;
        }
        if (error.status == 500) return ++faults < options_.tries_of_a_fault;
        // 507: a full disk may be emptied.
        return error.status == 408 || error.status == 429 || error.status == 502 || error.status == 503 || error.status == 504 || error.status == 507;
    }

    /// Waits before the next try; false if the sender is closing.
    bool wait(int attempt, double asked_s) noexcept {
        constexpr int doublings = 16;
        constexpr double longest_asked_s = 60;
        double ms = std::min<double>(options_.first_wait_ms * static_cast<double>(1 << std::min(attempt, doublings)), options_.longest_wait_ms);
        // Half of it is random, so that a fleet does not come back in step.
        ms *= std::uniform_real_distribution<double>(0.5, 1.0)(random_);
        if (asked_s >= 0) ms = std::max(ms, std::min(asked_s, longest_asked_s) * 1000);
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait_for(lock, std::chrono::duration<double, std::milli>(ms), [&] { return abandoned_.load(); });
        return !abandoned_.load();
    }

    void finish(Outcome::Kind kind, const std::string& id, Result<Answer> answer) noexcept {
        const bool is_good = answer.ok();
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (is_good) ++stats_.sent;
            else ++stats_.refused;
        }
        if (!options_.on_outcome) return;
        Outcome outcome;
        outcome.kind = kind;
        try {
            outcome.id = id;
        } catch (...) {
            // Without memory for its id it is reported all the same.
        }
        if (is_good) {
            outcome.status = answer->status;
            outcome.answer = std::move(answer->json);
        } else {
            outcome.status = answer.error().status;
            outcome.error = std::move(answer.error());
        }
        notify<const Outcome&>(options_.on_outcome, outcome);
    }

    void report_verdict(const std::string& keyframe, Json json) noexcept {
        if (!options_.on_verdict) return;
        auto verdict = verdict_of(std::move(json));
        if (!verdict) return finish(Outcome::Kind::question, keyframe, verdict.error());
        notify<const Verdict&>(options_.on_verdict, *verdict);
    }

    SenderOptions options_;
    std::unique_ptr<detail::Connection> connection_;
    std::minstd_rand random_;
    // Of the sender's thread alone.
    std::size_t batch_limit_ = max_batch;

    // Held for a few instructions at a time, never over input or output.
    mutable std::mutex mutex_;
    /// Something to send, or the end; only the sender's thread waits for it.
    std::condition_variable arrived_;
    /// Something was sent, or the end.
    std::condition_variable changed_;
    bool is_idle_ = false;
    std::list<Item> queue_;
    std::size_t bytes_ = 0;
    std::optional<Clock::time_point> flying_since_;
    std::size_t flying_count_ = 0;
    SenderStats stats_;
    bool closing_ = false;
    std::atomic<bool> abandoned_{false};

    detail::MissingKeyframes missing_;

    std::thread thread_;
};

}  // namespace revisit
