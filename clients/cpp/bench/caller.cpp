// What a call of the sender costs its caller: a keyframe of 1,000 features every 1/30 s, with a server that answers, is away, or never answers.
//
// bench_caller [seconds] [burners]; needs $REVISIT_BINARY. Prints, asserts nothing. So many threads burn the processors beside it.
//
// A call that takes long has waited for something, which is a voluntary switch of its thread (a lock that is taken), or lost its
// processor, which is an involuntary one (other work of the machine). Of the former there should be none.
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include <revisit/revisit.hpp>

#include "samples.hpp"
#include "server.hpp"
#include "stand_in.hpp"

using namespace revisit;
using Clock = std::chrono::steady_clock;

constexpr int keyframes_per_s = 30;

static double ms_since(Clock::time_point begun) { return std::chrono::duration<double, std::milli>(Clock::now() - begun).count(); }

static double percentile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// What the calling thread has used so far.
struct Used {
    double cpu_ms = 0;
    long waits = 0;
    long preemptions = 0;

    static Used now() {
        timespec cpu{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
        rusage usage{};
        getrusage(RUSAGE_THREAD, &usage);
        return {static_cast<double>(cpu.tv_sec) * 1e3 + static_cast<double>(cpu.tv_nsec) / 1e6, usage.ru_nvcsw, usage.ru_nivcsw};
    }
};

static void drive(const char* name, const std::string& url, int seconds) {
    SenderOptions options;
    options.endpoint.url = url;
    options.map = "bench";
    options.closing_ms = 0;
    auto sender = Sender::open(options);
    if (!sender) return;
    std::vector<double> copying, sending, cpu;
    long waits = 0, preemptions = 0;
    const auto begun = Clock::now();
    for (int i = 0; i < seconds * keyframes_per_s; ++i) {
        const auto host = samples::keyframe(static_cast<unsigned>(i));
        auto at = Clock::now();
        Keyframe copy = host;
        copying.push_back(ms_since(at));
        const Used before = Used::now();
        at = Clock::now();
        (void)(*sender)->send(std::move(copy), Question());
        sending.push_back(ms_since(at));
        const Used after = Used::now();
        cpu.push_back(after.cpu_ms - before.cpu_ms);
        waits += after.waits - before.waits;
        preemptions += after.preemptions - before.preemptions;
        std::this_thread::sleep_until(begun + std::chrono::milliseconds((i + 1) * 1000 / keyframes_per_s));
    }
    const auto stats = (*sender)->stats();
    std::printf("%-14s copy p50 %.3f ms p99 %.3f ms; send p50 %.3f ms p99 %.3f ms longest %.3f ms, of processor time p99 %.3f ms longest %.3f ms, waits %ld, preemptions %ld; sent %llu, queued %zu, dropped %llu, lag %.1f s\n",
                name, percentile(copying, 0.5), percentile(copying, 0.99), percentile(sending, 0.5), percentile(sending, 0.99), percentile(sending, 1), percentile(cpu, 0.99), percentile(cpu, 1), waits, preemptions,
                static_cast<unsigned long long>(stats.sent), stats.queued, static_cast<unsigned long long>(stats.dropped), stats.lag_s);
    std::fflush(stdout);
}

int main(int count, char** arguments) {
    const int seconds = count > 1 ? std::atoi(arguments[1]) : 10;
    std::atomic<bool> is_over{false};
    std::vector<std::thread> burners;
    for (int i = 0; i < (count > 2 ? std::atoi(arguments[2]) : 0); ++i) {
        burners.emplace_back([&] {
            while (!is_over) {
            }
        });
    }
    std::vector<double> encoding, compressing;
    std::size_t plain = 0, packed = 0;
    for (unsigned i = 0; i < 200; ++i) {
        const auto keyframe = samples::keyframe(4000 + i);
        auto at = Clock::now();
        auto text = to_json(keyframe);
        encoding.push_back(ms_since(at));
        plain = text->size();
        at = Clock::now();
        detail::compress(*text);
        compressing.push_back(ms_since(at));
        packed = text->size();
    }
    std::printf("encode         p50 %.3f ms p99 %.3f ms, %zu bytes; zstd p50 %.3f ms, %zu bytes (in the sender's thread)\n", percentile(encoding, 0.5), percentile(encoding, 0.99),
                plain, percentile(compressing, 0.5), packed);
    {
        Server server;
        drive("answers", server.url(), seconds);
    }
    drive("is away", "http://127.0.0.1:9", seconds);
    StandIn silent([](const HeardRequest&) { return GivenAnswer{200, "", "", true, false}; });
    drive("never answers", silent.url(), seconds);
    is_over = true;
    for (auto& burner : burners) burner.join();
}
