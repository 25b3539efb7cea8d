// Result of a call: a value or an error. No exception leaves this library.
#pragma once

#include <exception>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace revisit {

enum class Code {
    ok,
    /// The caller's data cannot be sent; `field` names what is wrong with it.
    invalid,
    /// The sender's queue is full; the call changed nothing.
    queue_full,
    /// The sender is closed.
    closed,
    /// The server could not be reached, or did not answer in time.
    unreachable,
    /// The request was given up because its sender is closing.
    abandoned,
    /// The server answered with a problem; `status`, `problem` and `faults` are its own.
    problem,
    /// The server's answer could not be read.
    malformed_answer,
    out_of_memory,
    /// A fault of this library, or of a callback.
    internal,
};

/// One fault of a body, as the server lists it.
struct Fault {
    std::string pointer;
    std::string detail;
    std::string got;
    std::string limit;
};

struct Error {
    Code code = Code::internal;
    /// JSON pointer of the offending field, such as `/features/keypoints/17`.
    std::string field;
    std::string detail;
    /// HTTP status of a problem, 0 without an answer.
    int status = 0;
    /// The problem's `code`, such as `invalid` or `not_found`.
    std::string problem;
    std::vector<Fault> faults;
    /// Seconds that the server asked to wait; negative if it did not.
    double retry_after_s = -1;
    /// Whether the server was there, perhaps, but did not answer in time.
    bool is_timeout = false;

    Error() noexcept = default;
    explicit Error(Code code_) noexcept : code(code_) {}
    Error(Code code_, std::string detail_) noexcept : code(code_), detail(std::move(detail_)) {}
    Error(Code code_, std::string field_, std::string detail_) noexcept
        : code(code_), field(std::move(field_)), detail(std::move(detail_)) {}
};

/// A value, or the reason why there is none.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) noexcept : value_(std::move(value)) {}
    Result(Error error) noexcept : error_(std::move(error)) {}

    bool ok() const noexcept { return value_.has_value(); }
    explicit operator bool() const noexcept { return ok(); }
    /// The value. Ends the program if there is none: ask `ok()` first.
    T& value() noexcept { return value_ ? *value_ : (std::terminate(), *value_); }
    const T& value() const noexcept { return value_ ? *value_ : (std::terminate(), *value_); }
    T* operator->() noexcept { return &value(); }
    const T* operator->() const noexcept { return &value(); }
    T& operator*() noexcept { return value(); }
    const T& operator*() const noexcept { return value(); }
    /// The error; its code is meaningless after success.
    const Error& error() const noexcept { return error_; }
    Error& error() noexcept { return error_; }

private:
    std::optional<T> value_;
    Error error_;
};

/// Success, or the reason against it.
class [[nodiscard]] Status {
public:
    Status() noexcept : error_(Code::ok) {}
    Status(Error error) noexcept : error_(std::move(error)) {}

    bool ok() const noexcept { return error_.code == Code::ok; }
    explicit operator bool() const noexcept { return ok(); }
    const Error& error() const noexcept { return error_; }

private:
    Error error_;
};

namespace detail {

/// Runs `work` and turns what it throws into an error.
template <class F>
auto guarded(F&& work) noexcept -> decltype(work()) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        // Empty strings need no memory.
        return Error(Code::out_of_memory);
    } catch (const std::exception& fault) {
        try {
            return Error(Code::internal, fault.what());
        } catch (...) {
            return Error(Code::internal);
        }
    } catch (...) {
        return Error(Code::internal);
    }
}

}  // namespace detail
}  // namespace revisit
