// Base64 of little-endian columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace revisit::detail {

/// Appends bytes as base64, a few at a time: what does not fill three bytes waits for the next ones.
class Base64Writer {
public:
    explicit Base64Writer(std::string& out) : out_(out) {}

    void bytes(const std::uint8_t* data, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            waiting_ = (waiting_ << 8) | data[i];
            if (++held_ == 3) {
                group(waiting_, 4);
                waiting_ = 0;
                held_ = 0;
            }
        }
    }

    /// Appends a number's bytes in little-endian order on every machine.
    template <class T>
    void number(T value) {
        static_assert(sizeof(T) == 4 || sizeof(T) == 8);
        std::uint64_t bits = 0;
        if constexpr (sizeof(T) == 4) {
            std::uint32_t narrow;
            std::memcpy(&narrow, &value, 4);
            bits = narrow;
        } else {
            std::memcpy(&bits, &value, 8);
        }
        std::uint8_t octets[sizeof(T)];
        for (auto& octet : octets) {
            octet = static_cast<std::uint8_t>(bits & 0xff);
            bits >>= 8;
        }
        bytes(octets, sizeof(T));
    }

    void finish() {
        if (held_ == 0) return;
        group(waiting_ << (8 * (3 - held_)), held_ + 1);
        out_.append(3 - held_, '=');
        waiting_ = 0;
        held_ = 0;
    }

private:
    void group(std::uint32_t bits, std::size_t chars) {
        constexpr char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (std::size_t i = 0; i < chars; ++i) out_ += alphabet[(bits >> (18 - 6 * i)) & 63];
    }

    std::string& out_;
    std::uint32_t waiting_ = 0;
    std::size_t held_ = 0;
};

/// Length of the base64 of `bytes` bytes.
constexpr std::size_t base64_chars(std::size_t bytes) { return (bytes + 2) / 3 * 4; }

}  // namespace revisit::detail
