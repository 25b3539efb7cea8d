// A thread that works behind others.
#pragma once

#if defined(__linux__)
#include <pthread.h>
#include <sched.h>
#endif

namespace revisit::detail {

/// Lets the calling thread be woken without taking the processor from the thread that wakes it. Its share of time stays the same.
inline void yield_to_callers() noexcept {
#if defined(SCHED_BATCH)
    // Without it, on busy processors, one call of the sender in seven gave its processor away, for 7 ms and more.
    const sched_param no_priority{};
    pthread_setschedparam(pthread_self(), SCHED_BATCH, &no_priority);
#endif
}

}  // namespace revisit::detail
