// The sender: the caller never waits, order is kept, an outage loses nothing, and what is lost is reported.
#include <algorithm>
#include <atomic>
#include <future>
#include <stdexcept>
#include <thread>

#include <nlohmann/json.hpp>
#include <revisit/revisit.hpp>

#include "check.hpp"
#include "samples.hpp"
#include "server.hpp"
#include "stand_in.hpp"

using namespace revisit;
using namespace std::chrono_literals;

// Longer than any test may last: it ends by what it waits for, or by ctest.
constexpr auto forever = 250s;

static SenderOptions options_for(const std::string& url) {
    SenderOptions options;
    options.endpoint.url = url;
    options.map = "tower";
    options.makes_map = false;
    options.first_wait_ms = 1;
    options.longest_wait_ms = 20;
    return options;
}

static std::unique_ptr<Sender> sender_of(SenderOptions options) {
    auto sender = Sender::open(std::move(options));
    CHECK_OK(sender);
    return std::move(*sender);
}

/// Collects outcomes of the sender's thread.
struct Heard {
    std::mutex mutex;
    std::vector<Outcome> outcomes;
    std::vector<Outcome> dropped;
    std::vector<Verdict> verdicts;

    void listen(SenderOptions& options) {
        options.on_outcome = [this](const Outcome& outcome) {
            const std::lock_guard<std::mutex> lock(mutex);
            outcomes.push_back(outcome);
        };
        options.on_dropped = [this](const Outcome& outcome) {
            const std::lock_guard<std::mutex> lock(mutex);
            dropped.push_back(outcome);
        };
        options.on_verdict = [this](const Verdict& verdict) {
            const std::lock_guard<std::mutex> lock(mutex);
            verdicts.push_back(verdict);
        };
    }
};

// The server takes the first request and never answers. Every call below returns while that request is still open: a call that waited
// for the network would never return, and ctest would end the test.
static void a_server_that_never_answers_holds_no_caller() {
    StandIn silent([](const HeardRequest&) { return GivenAnswer{200, "", "", true, false}; });
    Heard heard;
    auto options = options_for(silent.url());
    // The first request stays open through the test, however slow the machine is.
    options.endpoint.timeout_ms = 250'000;
    options.queue_items = 100;
    options.reserved_items = 10;
    options.closing_ms = 0;
    heard.listen(options);
    auto sender = sender_of(std::move(options));
    CHECK_OK(sender->send(samples::keyframe(1)));
    silent.wait_for(1);
    // The first one is with the sender's thread, so that 90 fit beside it.
    for (unsigned i = 2; i <= 91; ++i) CHECK_OK(sender->send(samples::keyframe(i), Question()));
    for (unsigned i = 92; i <= 95; ++i) {
        const auto status = sender->send(samples::keyframe(i));
        CHECK(status.error().code == Code::queue_full);
    }
    // What is small and must not be lost still fits.
    CHECK_OK(sender->correct({"robot-7", {"robot-7-1"}, {Pose()}, {}}));
    CHECK_OK(sender->confirm({"l-1", "robot-7-1", "robot-7-2", ""}));
    CHECK_OK(sender->revoke("l-1"));
    CHECK_OK(sender->update({"robot-7", {{1, 2}}, {}, {}}));
    CHECK_OK(sender->merge({"robot-7", "robot-8", {}, {}, {}}));
    CHECK_OK(sender->remove("robot-7-1"));
    auto stats = sender->stats();
    CHECK_EQUAL(stats.queued, 97u);
    CHECK_EQUAL(stats.dropped, 4u);
    CHECK_EQUAL(stats.sent, 0u);
    CHECK(stats.lag_s > 0);
    CHECK_EQUAL(silent.heard().size(), 1u);
    CHECK_EQUAL(heard.dropped.size(), 4u);
    CHECK_EQUAL(heard.dropped[0].id, "robot-7-92");
    CHECK(heard.dropped[0].error.code == Code::queue_full);
    // Closing reports each of the others, in order.
    CHECK_EQUAL(sender->close(0ms), 97u);
    CHECK_EQUAL(heard.dropped.size(), 101u);
    CHECK_EQUAL(heard.dropped[4].id, "robot-7-1");
    CHECK(heard.dropped[4].error.code == Code::abandoned);
    CHECK_EQUAL(sender->stats().dropped, 101u);
    CHECK(sender->send(samples::keyframe(1)).error().code == Code::closed);
}

static void bytes_bound_the_queue_too() {
    StandIn silent([](const HeardRequest&) { return GivenAnswer{200, "", "", true, false}; });
    auto options = options_for(silent.url());
    options.queue_bytes = 1'000'000;
    options.reserved_bytes = 100'000;
    options.closing_ms = 0;
    auto sender = sender_of(std::move(options));
    unsigned taken = 0;
    while (sender->send(samples::keyframe(taken + 1))) ++taken;
    const auto stats = sender->stats();
    CHECK(stats.queued_bytes <= 900'000);
    CHECK_EQUAL(stats.queued, taken);
    CHECK(taken > 5 && taken < 20);
}

static void everything_arrives_in_the_order_of_the_calls() {
    std::atomic<int> tries{0};
    StandIn stand_in([&](const HeardRequest&) {
        // Every third try fails in a way that must not change the order.
        const int number = tries++;
        if (number % 9 == 2) return GivenAnswer{503, R"({"code":"overloaded"})", "retry-after: 0\r\n", false, false};
        if (number % 9 == 5) return GivenAnswer{200, "", "", false, true};
        if (number % 9 == 8) return GivenAnswer{429, "busy", "", false, false};
        return GivenAnswer{201, R"({"loop":{"verdict":"no_loop"}})", "", false, false};
    });
    Heard heard;
    auto options = options_for(stand_in.url());
    heard.listen(options);
    auto sender = sender_of(std::move(options));
    std::vector<std::string> expected;
    for (unsigned i = 1; i <= 40; ++i) {
        CHECK_OK(sender->send(samples::keyframe(i, 20, 10, 5), Question()));
        expected.push_back("/v1/maps/tower/keyframes/robot-7-" + std::to_string(i) + "?query=loop");
        if (i % 10 == 0) {
            CHECK_OK(sender->correct({"robot-7", {"robot-7-1"}, {Pose()}, {}}));
            expected.push_back("/v1/maps/tower/poses");
        }
    }
    CHECK(sender->flush(forever));
    std::vector<std::string> arrived;
    for (const auto& request : stand_in.heard())
        if (arrived.empty() || arrived.back() != request.target) arrived.push_back(request.target);
    CHECK(arrived == expected);
    const auto stats = sender->stats();
    CHECK_EQUAL(stats.sent, 44u);
    CHECK_EQUAL(stats.refused + stats.dropped, 0u);
    CHECK(stats.retries > 10);
    CHECK_EQUAL(heard.outcomes.size(), 44u);
    for (const auto& outcome : heard.outcomes) CHECK(outcome.ok());
}

static void what_the_server_refuses_is_reported_and_left_out_of_corrections() {
    StandIn stand_in([](const HeardRequest& request) {
        if (request.target.find("robot-7-2") != std::string::npos) return GivenAnswer{422, R"({"code":"invalid","detail":"no","errors":[{"pointer":"/pose"}]})", "", false, false};
        return GivenAnswer{201, R"({"loop":{"verdict":"no_loop"}})", "", false, false};
    });
    Heard heard;
    auto options = options_for(stand_in.url());
    heard.listen(options);
    auto sender = sender_of(std::move(options));
    for (unsigned i = 1; i <= 3; ++i) CHECK_OK(sender->send(samples::keyframe(i, 20, 10, 5), Question()));
    CHECK_OK(sender->correct({"robot-7", {"robot-7-1", "robot-7-2", "robot-7-3"}, {Pose{{1, 0, 0}, {}}, Pose{{2, 0, 0}, {}}, Pose{{3, 0, 0}, {}}}, {}}));
    CHECK_OK(sender->update({"robot-7", {}, {}, {{"robot-7-2", std::vector<std::int64_t>{1}, {}}}}));
    CHECK_OK(sender->update({"robot-7", {{1, 2}}, {9}, {{"robot-7-3", std::vector<std::int64_t>{5, 6}, std::vector<Covisible>{{"robot-7-2", 20}, {"robot-7-1", 30}}}}}));
    CHECK(sender->flush(forever));
    const auto stats = sender->stats();
    CHECK_EQUAL(stats.refused, 1u);
    CHECK_EQUAL(heard.outcomes[1].id, "robot-7-2");
    CHECK_EQUAL(heard.outcomes[1].status, 422);
    CHECK_EQUAL(heard.outcomes[1].error.field, "/pose");
    const auto requests = stand_in.heard();
    // The update about the refused keyframe alone is not sent at all.
    CHECK_EQUAL(requests.size(), 5u);
    const auto poses = nlohmann::json::parse(requests[3].body);
    CHECK_EQUAL(poses["keyframes"]["ids"].dump(), R"(["robot-7-1","robot-7-3"])");
    CHECK_EQUAL(poses["keyframes"]["poses"][1]["translation"]["x"], 3);
    const auto update = nlohmann::json::parse(requests[4].body);
    CHECK_EQUAL(update.dump(), R"({"keyframes":[{"covisible":[{"keyframe":"robot-7-1","shared":30}],"keyframe":"robot-7-3","observes":[5,6]}],"removed":[9],"replaced":[[1,2]],"session":"robot-7"})");
}

// Another thread of the host may name a keyframe that was just removed: the server would refuse the whole of it.
static void a_removed_keyframe_is_left_out_of_what_follows() {
    Server server;
    auto options = options_for(server.url());
    options.makes_map = true;
    auto sender = sender_of(std::move(options));
    for (unsigned i = 1; i <= 2; ++i) CHECK_OK(sender->send(samples::keyframe(i, 20, 10, 5)));
    CHECK_OK(sender->remove("robot-7-2"));
    const auto tell = [&](std::int64_t culled, double x) {
        CHECK_OK(sender->update({"robot-7", {}, {culled}, {{"robot-7-1", std::vector<std::int64_t>{1}, {}}, {"robot-7-2", std::vector<std::int64_t>{1}, {}}}}));
        CHECK_OK(sender->correct({"robot-7", {"robot-7-1", "robot-7-2"}, {Pose{{x, 0, 0}, {}}, Pose{{x, 0, 0}, {}}}, {}}));
        CHECK(sender->flush(forever));
        CHECK_EQUAL(sender->stats().refused, 0u);
    };
    tell(301, 5);
    // Sent again, it is there again.
    CHECK_OK(sender->send(samples::keyframe(2, 20, 10, 5)));
    tell(302, 6);
    Endpoint endpoint;
    endpoint.url = server.url();
    auto client = Client::open(endpoint);
    CHECK_OK(client);
    for (const char* keyframe : {"robot-7-1", "robot-7-2"})
        CHECK_EQUAL(client->call("get_keyframe", {{{"map", "tower"}, {"keyframe", keyframe}}, {}, {}, {}})->json["pose"]["translation"]["x"].number(), 6.0);
}

// Written by the contract: the server's own endpoint is not there yet.
static void a_merge_is_written_as_the_contract_says() {
    StandIn stand_in([](const HeardRequest&) { return GivenAnswer{200, "{}", "", false, false}; });
    auto sender = sender_of(options_for(stand_in.url()));
    CHECK_OK(sender->merge({"robot-7.m1", "robot-7.m0", {2, {1, 2, 3}, {}}, 1000, {}}));
    CHECK_OK(sender->merge({"robot-7.m2", "robot-7.m0", {1, {1, 2, 3}, {}}, {}, {{5, 6}}}));
    CHECK(sender->flush(forever));
    const auto requests = stand_in.heard();
    CHECK_EQUAL(requests[0].method + requests[0].target, "POST/v1/maps/tower/sessions/robot-7.m1/merge");
    const auto first = nlohmann::json::parse(requests[0].body), second = nlohmann::json::parse(requests[1].body);
    CHECK_EQUAL(first["into"], "robot-7.m0");
    CHECK_EQUAL(first["into_from_session"]["scale"], 2);
    CHECK_EQUAL(first["into_from_session"]["translation"]["z"], 3);
    CHECK_EQUAL(first["into_from_session"]["rotation"]["w"], 1);
    CHECK_EQUAL(first["map_points"]["offset"], 1000);
    CHECK(!second["into_from_session"].contains("scale"));
    CHECK_EQUAL(second["map_points"]["ids"].dump(), "[[5,6]]");
}

static void a_faulty_callback_ends_nothing() {
    StandIn stand_in([](const HeardRequest&) { return GivenAnswer{201, "{}", "", false, false}; });
    auto options = options_for(stand_in.url());
    options.on_outcome = [](const Outcome&) { throw std::runtime_error("the host's fault"); };
    auto sender = sender_of(std::move(options));
    for (unsigned i = 1; i <= 3; ++i) CHECK_OK(sender->send(samples::keyframe(i, 20, 10, 5), Question()));
    CHECK(sender->flush(forever));
    CHECK_EQUAL(sender->stats().sent, 3u);
    CHECK_EQUAL(sender->stats().callback_faults, 3u);
}

static void a_lasting_fault_of_the_server_does_not_hold_the_queue() {
    std::atomic<int> tries{0};
    StandIn stand_in([&](const HeardRequest& request) {
        if (request.target.find("robot-7-1") == std::string::npos) return GivenAnswer{201, "{}", "", false, false};
        ++tries;
        return GivenAnswer{500, R"({"code":"internal"})", "", false, false};
    });
    auto sender = sender_of(options_for(stand_in.url()));
    CHECK_OK(sender->send(samples::keyframe(1, 20, 10, 5), Question()));
    CHECK_OK(sender->send(samples::keyframe(2, 20, 10, 5), Question()));
    CHECK(sender->flush(forever));
    CHECK_EQUAL(sender->stats().sent, 1u);
    CHECK_EQUAL(sender->stats().refused, 1u);
    CHECK_EQUAL(tries.load(), 5);
}

// The server is away for the first half of what is sent, then for as long as a crash and a restart take.
static void an_outage_loses_nothing() {
    Server server;
    Heard heard;
    auto options = options_for(server.url());
    options.makes_map = true;
    heard.listen(options);
    server.kill_now();
    auto sender = sender_of(std::move(options));
    constexpr unsigned keyframes = 120;
    for (unsigned i = 1; i <= keyframes / 2; ++i) CHECK_OK(sender->send(samples::keyframe(i, 50, 20, 10)));
    while (sender->stats().retries < 3) std::this_thread::sleep_for(1ms);
    CHECK(sender->stats().unreachable);
    CHECK_EQUAL(sender->stats().queued, keyframes / 2);
    server.start();
    while (sender->stats().sent < keyframes / 4) std::this_thread::sleep_for(1ms);
    server.kill_now();
    for (unsigned i = keyframes / 2 + 1; i <= keyframes; ++i) CHECK_OK(sender->send(samples::keyframe(i, 50, 20, 10)));
    server.start();
    CHECK(sender->flush(forever));
    const auto stats = sender->stats();
    CHECK_EQUAL(stats.sent, keyframes);
    CHECK_EQUAL(stats.refused + stats.dropped, 0u);
    CHECK(!stats.unreachable);
    CHECK_EQUAL(stats.lag_s, 0.0);
    Endpoint endpoint;
    endpoint.url = server.url();
    auto client = Client::open(endpoint);
    CHECK_OK(client);
    // Sent again each is a retry, which the server says only of the same body.
    for (unsigned i = 1; i <= keyframes; ++i) {
        const auto again = client->put_keyframe("tower", samples::keyframe(i, 50, 20, 10));
        CHECK_OK(again);
        CHECK(again->is_replayed);
    }
}

static void verdicts_come_back_however_the_question_is_asked() {
    Server server;
    Heard heard;
    auto options = options_for(server.url());
    options.makes_map = true;
    heard.listen(options);
    auto sender = sender_of(std::move(options));
    CHECK_OK(sender->send(samples::plate("kf-1", 0, 1, "901"), Question()));
    CHECK_OK(sender->send(samples::plate("kf-2", 5, 90, "Room 901"), Question()));
    CHECK_OK(sender->send(samples::plate("kf-3", 15, 120, "910"), Question{Question::Verify::anchors, 0, true}));
    CHECK_OK(sender->ask("kf-2", Question{Question::Verify::geometry, 0, false}));
    CHECK_OK(sender->confirm({"l-1", "kf-2", "kf-1", ""}));
    CHECK_OK(sender->ask("kf-2"));
    CHECK_OK(sender->revoke("l-1"));
    CHECK_OK(sender->remove("kf-3"));
    CHECK(sender->flush(forever));
    CHECK_EQUAL(heard.verdicts.size(), 5u);
    CHECK_EQUAL(heard.verdicts[0].reason, "no_candidates");
    CHECK(heard.verdicts[1].decision == Decision::loop);
    CHECK_EQUAL(heard.verdicts[1].keyframe, "kf-2");
    CHECK(heard.verdicts[2].decision == Decision::no_loop);
    CHECK(heard.verdicts[2].candidates.empty());
    CHECK(heard.verdicts[3].decision == Decision::undecided);
    CHECK_EQUAL(heard.verdicts[4].reason, "already_closed");
    for (const auto& outcome : heard.outcomes) CHECK(outcome.ok());
}

// While the first request is held, the others wait behind it, and then share requests. One of them is refused, one repeats another.
static void a_backlog_shares_requests() {
    Server server;
    std::promise<void> release;
    auto released = release.get_future().share();
    Heard heard;
    auto options = options_for(server.url());
    options.makes_map = true;
    heard.listen(options);
    options.on_outcome = [&, next = options.on_outcome](const Outcome& outcome) {
        next(outcome);
        released.wait();
    };
    auto sender = sender_of(std::move(options));
    CHECK_OK(sender->send(samples::keyframe(0, 20, 10, 5)));
    auto conflicting = samples::keyframe(3, 20, 10, 5);
    conflicting.stamp.sec += 1;
    for (unsigned i = 1; i <= 150; ++i) CHECK_OK(sender->send(i == 100 ? conflicting : samples::keyframe(i == 101 ? 3 : i, 20, 10, 5)));
    CHECK_OK(sender->correct({"robot-7", {"robot-7-1", "robot-7-150"}, {Pose(), Pose()}, {}}));
    release.set_value();
    CHECK(sender->flush(forever));
    CHECK_EQUAL(heard.outcomes.size(), 152u);
    for (unsigned i = 0; i <= 150; ++i) {
        const auto& outcome = heard.outcomes[i];
        CHECK_EQUAL(outcome.id, "robot-7-" + std::to_string(i == 100 || i == 101 ? 3 : i));
        CHECK_EQUAL(outcome.status, i == 100 ? 409 : i == 101 ? 200 : 201);
    }
    CHECK(heard.outcomes[100].error.code == Code::problem);
    CHECK(!heard.outcomes[100].error.problem.empty());
    CHECK_EQUAL(sender->stats().sent, 151u);
    CHECK_EQUAL(sender->stats().refused, 1u);
    CHECK_EQUAL(sender->stats().queued_bytes, 0u);
}

// The requests of a backlog, as a server sees them: a few, in order, and what fails for the moment comes again.
static void a_line_that_fails_for_the_moment_is_sent_again() {
    StandIn stand_in([](const HeardRequest& request) {
        if (request.method == "PUT") return GivenAnswer{201, "{}", "", false, false};
        std::string lines;
        int number = 0;
        for (std::size_t at = 0; at < request.body.size(); at = request.body.find('\n', at) + 1) {
            const auto keyframe = nlohmann::json::parse(request.body.substr(at, request.body.find('\n', at) - at));
            lines += nlohmann::json{{"line", ++number}, {"id", keyframe["id"]}, {"status", number % 10 == 5 ? 507 : 201}}.dump() + "\n";
        }
        return GivenAnswer{207, lines, "", false, false};
    });
    Heard heard;
    auto options = options_for(stand_in.url());
    heard.listen(options);
    auto sender = sender_of(std::move(options));
    for (unsigned i = 1; i <= 200; ++i) CHECK_OK(sender->send(samples::keyframe(i, 20, 10, 5)));
    CHECK(sender->flush(forever));
    CHECK_EQUAL(sender->stats().sent, 200u);
    std::set<std::string> ids;
    for (const auto& outcome : heard.outcomes) ids.insert(outcome.id);
    CHECK_EQUAL(ids.size(), 200u);
}

// A server that does not get through with more than four keyframes in time, and one that it does not get through with at first.
static void a_batch_that_takes_too_long_is_sent_in_parts() {
    std::atomic<std::size_t> largest_answered{0};
    std::atomic<bool> is_slow{true};
    StandIn stand_in([&](const HeardRequest& request) {
        if (request.method == "PUT") return GivenAnswer{201, "{}", "", false, false};
        std::string lines;
        std::size_t number = 0;
        for (std::size_t at = 0; at < request.body.size(); at = request.body.find('\n', at) + 1) {
            const auto keyframe = nlohmann::json::parse(request.body.substr(at, request.body.find('\n', at) - at));
            lines += nlohmann::json{{"line", ++number}, {"id", keyframe["id"]}, {"status", 201}}.dump() + "\n";
        }
        if (is_slow && number > 4) return GivenAnswer{200, "", "", true, false};
        largest_answered = std::max(largest_answered.load(), number);
        return GivenAnswer{207, lines, "", false, false};
    });
    Heard heard;
    auto options = options_for(stand_in.url());
    options.endpoint.timeout_ms = 500;
    heard.listen(options);
    auto sender = sender_of(std::move(options));
    for (unsigned i = 1; i <= 100; ++i) CHECK_OK(sender->send(samples::keyframe(i, 20, 10, 5)));
    while (sender->stats().sent < 30) std::this_thread::sleep_for(1ms);
    is_slow = false;
    CHECK(sender->flush(forever));
    CHECK_EQUAL(sender->stats().sent, 100u);
    CHECK_EQUAL(heard.outcomes.size(), 100u);
    // In the order of the calls, each once.
    for (unsigned i = 1; i <= 100; ++i) CHECK_EQUAL(heard.outcomes[i - 1].id, "robot-7-" + std::to_string(i));
    CHECK(largest_answered > 1);
    CHECK_EQUAL(sender->stats().queued_bytes, 0u);
}

static void many_callers_share_a_sender() {
    StandIn stand_in([](const HeardRequest&) { return GivenAnswer{201, "{}", "", false, false}; });
    auto sender = sender_of(options_for(stand_in.url()));
    constexpr unsigned callers = 4, each = 50;
    std::vector<std::thread> threads;
    for (unsigned caller = 0; caller < callers; ++caller) {
        threads.emplace_back([&, caller] {
            for (unsigned i = 0; i < each; ++i) {
                CHECK_OK(sender->send(samples::keyframe(caller * each + i, 10, 5, 2)));
                (void)sender->stats();
            }
        });
    }
    for (auto& thread : threads) thread.join();
    CHECK(sender->flush(forever));
    CHECK_EQUAL(sender->stats().sent, callers * each);
}

static void bad_options_are_refused() {
    CHECK_EQUAL(Sender::open(options_for("ftp://x")).error().field, "/url");
    auto options = options_for("http://x");
    options.map = "a b";
    CHECK_EQUAL(Sender::open(options).error().field, "/map");
    options = options_for("http://x");
    options.endpoint.key = "a\r\nb";
    CHECK_EQUAL(Sender::open(options).error().field, "/key");
    options = options_for("http://x");
    options.queue_items = 1;
    CHECK_EQUAL(Sender::open(options).error().field, "/queue_items");
    auto bad = samples::keyframe(1, 10, 5, 2);
    bad.features.keypoints[3].u = std::nanf("");
    auto sender = sender_of(options_for("http://127.0.0.1:9"));
    CHECK_EQUAL(sender->send(bad).error().field, "/features/keypoints/3");
    CHECK_EQUAL(sender->stats().queued, 0u);
    CHECK_EQUAL(sender->revoke("").error().field, "/loop");
}

int main() {
    TEST(a_server_that_never_answers_holds_no_caller);
    TEST(bytes_bound_the_queue_too);
    TEST(everything_arrives_in_the_order_of_the_calls);
    TEST(what_the_server_refuses_is_reported_and_left_out_of_corrections);
    TEST(a_removed_keyframe_is_left_out_of_what_follows);
    TEST(a_merge_is_written_as_the_contract_says);
    TEST(a_faulty_callback_ends_nothing);
    TEST(a_lasting_fault_of_the_server_does_not_hold_the_queue);
    TEST(an_outage_loses_nothing);
    TEST(verdicts_come_back_however_the_question_is_asked);
    TEST(a_backlog_shares_requests);
    TEST(a_line_that_fails_for_the_moment_is_sent_again);
    TEST(a_batch_that_takes_too_long_is_sent_in_parts);
    TEST(many_callers_share_a_sender);
    TEST(bad_options_are_refused);
}
