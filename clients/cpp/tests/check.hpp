// A test's checks: the first that fails ends the program with its place.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <sstream>
#include <string>

namespace checks {

[[noreturn]] inline void fail(const char* file, int line, const std::string& what) {
    std::fflush(stdout);
    std::fprintf(stderr, "%s:%d: %s\n", file, line, what.c_str());
    std::_Exit(1);
}

template <class A, class B>
void equal(const A& found, const B& expected, const char* text, const char* file, int line) {
    if (found == expected) return;
    std::ostringstream out;
    out << text << " is " << found << ", expected " << expected;
    fail(file, line, out.str());
}

inline void run(const char* name, const std::function<void()>& test) {
    std::printf("%s\n", name);
    std::fflush(stdout);
    test();
}

}  // namespace checks

#define CHECK(condition) \
    do { \
        if (!(condition)) checks::fail(__FILE__, __LINE__, #condition); \
    } while (false)
#define CHECK_EQUAL(found, expected) checks::equal((found), (expected), #found, __FILE__, __LINE__)
#define CHECK_OK(result) \
    do { \
        const auto& checked = (result); \
        if (!checked) checks::fail(__FILE__, __LINE__, #result ": " + std::to_string(static_cast<int>(checked.error().code)) + " " + checked.error().field + " " + checked.error().detail); \
    } while (false)
#define TEST(name) checks::run(#name, name)
