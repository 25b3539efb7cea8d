// Memory that runs out at any allocation of a call becomes an error: no exception leaves the library, and nothing breaks.
#include <cstdlib>
#include <new>
#include <thread>

#include <revisit/revisit.hpp>

#include "check.hpp"
#include "samples.hpp"
#include "stand_in.hpp"

// Of this thread: how many allocations succeed before one fails; negative for no limit.
static thread_local long allowed = -1;

static void* allocate(std::size_t size) {
    if (allowed == 0) throw std::bad_alloc();
    if (allowed > 0) --allowed;
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}

// Inlined, gcc takes the pair for a mismatched one.
#define NEVER_INLINED __attribute__((noinline))
NEVER_INLINED void* operator new(std::size_t size) { return allocate(size); }
NEVER_INLINED void* operator new[](std::size_t size) { return allocate(size); }
NEVER_INLINED void operator delete(void* memory) noexcept { std::free(memory); }
NEVER_INLINED void operator delete[](void* memory) noexcept { std::free(memory); }
NEVER_INLINED void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
NEVER_INLINED void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

using namespace revisit;

/// Calls `work` with every number of allocations from none on, until it succeeds; returns how many it needed.
template <class F>
static long with_ever_more_memory(F&& work) {
    for (long count = 0;; ++count) {
        allowed = count;
        const auto result = work();
        allowed = -1;
        if (result) return count;
        CHECK(result.error().code == Code::out_of_memory);
    }
}

static void encoding_and_reading_run_out_of_memory() {
    const auto keyframe = samples::keyframe(1, 50, 20, 10);
    CHECK(with_ever_more_memory([&] { return to_json(keyframe); }) >= 1);
    CHECK(with_ever_more_memory([] { return Json::parse(R"({"a long name of a member":["a long text in a list",{}],"b":1})"); }) > 3);
    auto bad = keyframe;
    bad.features.keypoints[7].u = std::nanf("");
    // A refusal needs memory for its words, and says so where there is none.
    with_ever_more_memory([&]() -> Status {
        const auto status = check(bad);
        return status.error().code == Code::invalid ? Status() : status;
    });
}

static void calls_run_out_of_memory() {
    StandIn stand_in([](const HeardRequest&) { return GivenAnswer{201, R"({"loop":{"verdict":"loop","loops":["a keyframe with a long name"]}})", "", false, false}; });
    Endpoint endpoint;
    endpoint.url = stand_in.url();
    CHECK(with_ever_more_memory([&] { return Client::open(endpoint); }) > 1);
    auto client = Client::open(endpoint);
    CHECK_OK(client);
    const std::string map = "a-map-with-a-long-name";
    const auto keyframe = samples::plate("k", 0, 1, "901");
    CHECK(with_ever_more_memory([&] { return client->put_keyframe(map, keyframe); }) > 5);
}

static void a_sender_takes_a_keyframe_or_says_that_memory_ran_out() {
    StandIn stand_in([](const HeardRequest&) { return GivenAnswer{201, "{}", "", false, false}; });
    SenderOptions options;
    options.endpoint.url = stand_in.url();
    options.map = "tower";
    options.makes_map = false;
    const long opening = with_ever_more_memory([&]() -> Result<std::unique_ptr<Sender>> {
        // The copy of the options is the caller's.
        const long left = allowed;
        allowed = -1;
        SenderOptions copy = options;
        allowed = left;
        return Sender::open(std::move(copy));
    });
    CHECK(opening > 3);
    auto sender = Sender::open(options);
    CHECK_OK(sender);
    const auto keyframe = samples::keyframe(1, 50, 20, 10);
    const long needed = with_ever_more_memory([&]() -> Status {
        const long left = allowed;
        allowed = -1;
        Keyframe copy = keyframe;
        allowed = left;
        return (*sender)->send(std::move(copy));
    });
    std::printf("  enqueuing a moved keyframe allocates %ld times\n", needed);
    CHECK((*sender)->flush(std::chrono::seconds(250)));
    CHECK_EQUAL((*sender)->stats().sent, 1u);
}

int main() {
    TEST(encoding_and_reading_run_out_of_memory);
    TEST(calls_run_out_of_memory);
    TEST(a_sender_takes_a_keyframe_or_says_that_memory_ran_out);
}
