// Numbers and strings as JSON text.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

namespace revisit::detail {

/// The longest text of a finite double in fixed notation with few decimals: 309 digits, sign, point, decimals.
constexpr std::size_t number_chars = 352;

inline void append_integer(std::string& out, std::int64_t value) {
    char text[24];
    const auto end = std::to_chars(text, text + sizeof text, value);
    out.append(text, end.ptr);
}

/// Appends the shortest text that reads back as the same number.
inline void append_number(std::string& out, double value) {
    char text[number_chars];
    const auto end = std::to_chars(text, text + sizeof text, value);
    out.append(text, end.ptr);
}

/// Rounds to `decimals` after the point: half away from zero, as printed figures are.
inline double rounded(double value, int decimals) {
    double scale = 1;
    for (int i = 0; i < decimals; ++i) scale *= 10;
    return std::round(value * scale) / scale;
}

/// Appends at most `decimals` after the point, without trailing zeros.
inline void append_decimals(std::string& out, double value, int decimals) {
    // Above it a double has no such decimals left, and fixed notation would grow long.
    constexpr double largest_fixed = 1e9;
    if (std::fabs(value) >= largest_fixed) return append_number(out, value);
    char text[number_chars];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals);
    char* last = end.ptr;
    if (decimals > 0) {
        while (last[-1] == '0') --last;
        if (last[-1] == '.') --last;
    }
    const std::string_view written(text, static_cast<std::size_t>(last - text));
    out.append(written == "-0" ? std::string_view("0") : written);
}

/// How long `append_integer` would be.
inline std::size_t integer_chars(std::int64_t value) {
    char text[24];
    return static_cast<std::size_t>(std::to_chars(text, text + sizeof text, value).ptr - text);
}

inline void append_string(std::string& out, std::string_view value) {
    constexpr char hex[] = "0123456789abcdef";
    out += '"';
    for (const char c : value) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += '\\';
            out += c;
        } else if (byte < 0x20) {
            out += "\\u00";
            out += hex[byte >> 4];
            out += hex[byte & 15];
        } else {
            out += c;
        }
    }
    out += '"';
}

/// Whether a text is UTF-8, which JSON must be.
inline bool is_utf8(std::string_view text) noexcept {
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const std::size_t more = lead < 0x80 ? 0 : lead >= 0xc2 && lead < 0xe0 ? 1 : (lead & 0xf0) == 0xe0 ? 2 : lead >= 0xf0 && lead < 0xf5 ? 3 : 4;
        if (more == 4 || i + more >= text.size()) return false;
        for (std::size_t k = 1; k <= more; ++k)
            if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return false;
        const auto second = more > 0 ? static_cast<unsigned char>(text[i + 1]) : 0;
        // Overlong forms, surrogates, and what lies beyond U+10FFFF.
        if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second > 0x9f) || (lead == 0xf0 && second < 0x90) || (lead == 0xf4 && second > 0x8f))
            return false;
        i += more + 1;
    }
    return true;
}

}  // namespace revisit::detail
