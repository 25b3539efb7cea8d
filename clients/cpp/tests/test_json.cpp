// JSON values: what is read is what is written, and what is no JSON is refused.
#include <revisit/json.hpp>

#include "check.hpp"

using revisit::Json;

static std::string again(const std::string& text) {
    auto json = Json::parse(text);
    CHECK_OK(json);
    std::string out;
    json->write(out);
    return out;
}

static void reads_what_it_writes() {
    const char* same[] = {
        "null", "true", "[]", "{}", "0", "-7", "9007199254740993", "-9223372036854775808", "0.1", "1e+300", "\"a \\\"b\\\\\"",
        R"({"a":[1,2.5,{"b":null}],"c":"d"})", "\"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\"", "\"\\u0000\\u001f\"",
    };
    for (const auto* text : same) CHECK_EQUAL(again(text), text);
    CHECK_EQUAL(again(" [ 1 , 2 ]\n"), "[1,2]");
    CHECK_EQUAL(again(R"("\u00e4\u20ac\ud83d\ude00\n")"), "\"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\\u000a\"");
    CHECK_EQUAL(Json::parse("18446744073709551616")->number(), 18446744073709551616.0);
}

static void refuses_what_is_no_json() {
    const char* bad[] = {
        "", " ", "{", "[1,", "[1,]", "{\"a\"}", "{\"a\":}", "{a:1}", "01", "-", "1.", ".5", "1e", "+1", "nul", "truefalse", "\"a", "\"\\x\"", "\"\\u12\"",
        "\"\\ud800\"", "\"\\udc00\"", "\"\t\"", "[1] 2", "NaN", "Infinity", "1e999",
    };
    for (const auto* text : bad) {
        auto json = Json::parse(text);
        if (json) checks::fail(__FILE__, __LINE__, std::string("read as JSON: ") + text);
        CHECK(json.error().code == revisit::Code::malformed_answer);
    }
    CHECK(!Json::parse(std::string(100'000, '[')));
}

static void asks_for_what_is_not_there() {
    auto json = Json::parse(R"({"a":{"b":1}})");
    CHECK_EQUAL((*json)["a"]["b"].integer(), 1);
    CHECK((*json)["x"]["y"]["z"].is_null());
    CHECK_EQUAL((*json)["a"].text(), "");
    CHECK_EQUAL((*json)["a"].number(7), 7.0);
}

int main() {
    TEST(reads_what_it_writes);
    TEST(refuses_what_is_no_json);
    TEST(asks_for_what_is_not_there);
}
