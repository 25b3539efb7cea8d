// JSON value: reads the server's answers, fields of later versions included, and writes bodies.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "number_text.hpp"
#include "result.hpp"

namespace revisit {

/// A JSON value. Asking for what is not there gives null, empty or zero, never a fault.
class Json {
public:
    enum class Type { null, boolean, number, text, list, object };
    using Member = std::pair<std::string, Json>;

    Json() noexcept = default;
    static Json of(bool value) { Json json; json.type_ = Type::boolean; json.integer_ = value; return json; }
    static Json of(double value) { Json json; json.type_ = Type::number; json.number_ = value; return json; }
    static Json of(std::int64_t value) {
        Json json;
        json.type_ = Type::number;
        json.number_ = static_cast<double>(value);
        json.integer_ = value;
        json.is_integer_ = true;
        return json;
    }
    static Json of(std::string value) { Json json; json.type_ = Type::text; json.text_ = std::move(value); return json; }
    static Json list() { Json json; json.type_ = Type::list; return json; }
    static Json object() { Json json; json.type_ = Type::object; return json; }

    static Result<Json> parse(std::string_view text) noexcept;

    Type type() const noexcept { return type_; }
    bool is_null() const noexcept { return type_ == Type::null; }
    bool boolean() const noexcept { return type_ == Type::boolean && integer_ != 0; }
    double number(double otherwise = 0) const noexcept { return type_ == Type::number ? number_ : otherwise; }
    std::int64_t integer(std::int64_t otherwise = 0) const noexcept { return is_integer_ ? integer_ : otherwise; }
    bool is_integer() const noexcept { return is_integer_; }
    const std::string& text() const noexcept { return text_; }
    const std::vector<Json>& items() const noexcept { return items_; }
    const std::vector<Member>& members() const noexcept { return members_; }

    /// The member of that name, or null.
    const Json& operator[](std::string_view name) const noexcept {
        static const Json nothing;
        for (const auto& member : members_)
            if (member.first == name) return member.second;
        return nothing;
    }

    Json& add(std::string name, Json value) { members_.emplace_back(std::move(name), std::move(value)); return *this; }
    Json& add(Json item) { items_.push_back(std::move(item)); return *this; }

    void write(std::string& out) const {
        switch (type_) {
            case Type::null: out += "null"; break;
            case Type::boolean: out += integer_ ? "true" : "false"; break;
            case Type::number: is_integer_ ? detail::append_integer(out, integer_) : detail::append_number(out, number_); break;
            case Type::text: detail::append_string(out, text_); break;
            case Type::list:
                out += '[';
                for (std::size_t i = 0; i < items_.size(); ++i) {
                    if (i > 0) out += ',';
                    items_[i].write(out);
                }
                out += ']';
                break;
            case Type::object:
                out += '{';
                for (std::size_t i = 0; i < members_.size(); ++i) {
                    if (i > 0) out += ',';
                    detail::append_string(out, members_[i].first);
                    out += ':';
                    members_[i].second.write(out);
                }
                out += '}';
                break;
        }
    }

private:
    class Reader;

    Type type_ = Type::null;
    bool is_integer_ = false;
    std::int64_t integer_ = 0;
    double number_ = 0;
    std::string text_;
    std::vector<Json> items_;
    std::vector<Member> members_;
};

class Json::Reader {
public:
    explicit Reader(std::string_view text) : at_(text.data()), end_(text.data() + text.size()), begin_(text.data()) {}

    Result<Json> document() {
        Json json;
        if (!value(json, 0) || (space(), at_ != end_))
            return Error(Code::malformed_answer, "not JSON at byte " + std::to_string(at_ - begin_));
        return json;
    }

private:
    // The server's deepest answer has 8 levels; the bound keeps a hostile one off the stack.
    static constexpr int max_depth = 64;

    void space() {
        while (at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\n' || *at_ == '\r')) ++at_;
    }
    bool take(char c) {
        space();
        if (at_ == end_ || *at_ != c) return false;
        ++at_;
        return true;
    }
    bool word(std::string_view expected) {
        if (static_cast<std::size_t>(end_ - at_) < expected.size() || std::string_view(at_, expected.size()) != expected) return false;
        at_ += expected.size();
        return true;
    }

    bool value(Json& json, int depth) {
        space();
        if (at_ == end_ || depth > max_depth) return false;
        switch (*at_) {
            case '{': return object(json, depth);
            case '[': return list(json, depth);
            case '"': json.type_ = Type::text; return string(json.text_);
            case 't': json = of(true); return word("true");
            case 'f': json = of(false); return word("false");
            case 'n': json = Json(); return word("null");
            default: return number(json);
        }
    }

    bool object(Json& json, int depth) {
        json.type_ = Type::object;
        ++at_;
        if (take('}')) return true;
        do {
            space();
            Member member;
            if (at_ == end_ || *at_ != '"' || !string(member.first) || !take(':') || !value(member.second, depth + 1)) return false;
            json.members_.push_back(std::move(member));
        } while (take(','));
        return take('}');
    }

    bool list(Json& json, int depth) {
        json.type_ = Type::list;
        ++at_;
        if (take(']')) return true;
        do {
            Json item;
            if (!value(item, depth + 1)) return false;
            json.items_.push_back(std::move(item));
        } while (take(','));
        return take(']');
    }

    bool digits() {
        const char* first = at_;
        while (at_ != end_ && *at_ >= '0' && *at_ <= '9') ++at_;
        return at_ != first;
    }

    bool number(Json& json) {
        const char* first = at_;
        bool whole = true;
        if (*at_ == '-') ++at_;
        const bool zero = at_ != end_ && *at_ == '0';
        const char* leading = at_;
        if (!digits() || (zero && at_ - leading > 1)) return false;
        if (at_ != end_ && *at_ == '.') {
            whole = false;
            ++at_;
            if (!digits()) return false;
        }
        if (at_ != end_ && (*at_ == 'e' || *at_ == 'E')) {
            whole = false;
            ++at_;
            if (at_ != end_ && (*at_ == '+' || *at_ == '-')) ++at_;
            if (!digits()) return false;
        }
        json = of(0.0);
        if (whole && std::from_chars(first, at_, json.integer_).ec == std::errc()) {
            json = of(json.integer_);
            return true;
        }
        return std::from_chars(first, at_, json.number_).ec == std::errc();
    }

    bool four(std::uint32_t& unit) {
        if (end_ - at_ < 4) return false;
        const auto read = std::from_chars(at_, at_ + 4, unit, 16);
        if (read.ptr != at_ + 4) return false;
        at_ += 4;
        return true;
    }

    bool escaped(std::string& out) {
        if (at_ == end_) return false;
        switch (*at_++) {
            case '"': out += '"'; return true;
            case '\\': out += '\\'; return true;
            case '/': out += '/'; return true;
            case 'b': out += '\b'; return true;
            case 'f': out += '\f'; return true;
            case 'n': out += '\n'; return true;
            case 'r': out += '\r'; return true;
            case 't': out += '\t'; return true;
            case 'u': break;
            default: return false;
        }
        std::uint32_t code = 0;
        if (!four(code)) return false;
        if (code >= 0xd800 && code < 0xdc00) {
            std::uint32_t low = 0;
            if (!word("\\u") || !four(low) || low < 0xdc00 || low > 0xdfff) return false;
            code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
        } else if (code >= 0xdc00 && code < 0xe000) {
            return false;
        }
        if (code < 0x80) {
            out += static_cast<char>(code);
        } else if (code < 0x800) {
            out += static_cast<char>(0xc0 | (code >> 6));
            out += static_cast<char>(0x80 | (code & 63));
        } else if (code < 0x10000) {
            out += static_cast<char>(0xe0 | (code >> 12));
            out += static_cast<char>(0x80 | ((code >> 6) & 63));
            out += static_cast<char>(0x80 | (code & 63));
        } else {
            out += static_cast<char>(0xf0 | (code >> 18));
            out += static_cast<char>(0x80 | ((code >> 12) & 63));
            out += static_cast<char>(0x80 | ((code >> 6) & 63));
            out += static_cast<char>(0x80 | (code & 63));
        }
        return true;
    }

    bool string(std::string& out) {
        ++at_;
        while (at_ != end_ && *at_ != '"') {
            if (static_cast<unsigned char>(*at_) < 0x20) return false;
            if (*at_ == '\\') {
                ++at_;
                if (!escaped(out)) return false;
            } else {
                out += *at_++;
            }
        }
        if (at_ == end_) return false;
        ++at_;
        return true;
    }

    const char* at_;
    const char* end_;
    const char* begin_;
};

inline Result<Json> Json::parse(std::string_view text) noexcept {
    return detail::guarded([&]() -> Result<Json> { return Reader(text).document(); });
}

}  // namespace revisit
