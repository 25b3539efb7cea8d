// The pairs of clients/conformance, by the generic call.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>

#include <nlohmann/json.hpp>
#include <revisit/revisit.hpp>

#include "check.hpp"
#include "server.hpp"
#include "stand_in.hpp"

using nlohmann::json;

static std::vector<json> read_all(const char* folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(REVISIT_CONFORMANCE) / folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<json> pairs;
    for (const auto& file : files) pairs.push_back(json::parse(std::ifstream(file)));
    CHECK(!pairs.empty());
    return pairs;
}

static revisit::Names names(const json& request, const char* field) {
    revisit::Names out;
    if (!request.contains(field)) return out;
    for (const auto& [name, value] : request[field].items()) out.emplace_back(name, value.is_string() ? value.get<std::string>() : value.dump());
    return out;
}

static revisit::Result<revisit::Answer> ask(revisit::Client& client, const json& pair) {
    const auto& request = pair["request"];
    return client.call(pair["operation"], {names(request, "path"), names(request, "query"), names(request, "headers"), request.contains("body") ? request["body"].dump() : ""});
}

/// Every expected field is there with its value; more may be there.
static void holds(const json& found, const json& expected, const std::string& where) {
    const auto fail = [&] { checks::fail(__FILE__, __LINE__, where + " is " + found.dump() + ", expected " + expected.dump()); };
    if (expected.is_object()) {
        for (const auto& [name, value] : expected.items()) {
            if (!found.is_object() || !found.contains(name)) fail();
            holds(found[name], value, where + "/" + name);
        }
    } else if (expected.is_array()) {
        if (!found.is_array() || found.size() != expected.size()) fail();
        for (std::size_t i = 0; i < expected.size(); ++i) holds(found[i], expected[i], where + "/" + std::to_string(i));
    } else if (expected.is_number_float()) {
        if (!found.is_number() || std::fabs(found.get<double>() - expected.get<double>()) > 1e-6) fail();
    } else if (found != expected) {
        fail();
    }
}

static json plain(const revisit::Json& value) {
    std::string text;
    value.write(text);
    return json::parse(text);
}

static void every_pair_holds_against_the_running_server() {
    Server server;
    revisit::Endpoint endpoint;
    endpoint.url = server.url();
    auto client = revisit::Client::open(endpoint);
    CHECK_OK(client);
    for (const auto& pair : read_all("pairs")) {
        const std::string name = pair["name"];
        const auto& response = pair["response"];
        const auto answer = ask(*client, pair);
        if (response["status"] < 400) {
            CHECK_OK(answer);
            CHECK_EQUAL(answer->status, response["status"].get<int>());
            if (response.contains("body")) holds(plain(answer->json), response["body"], name);
            const auto headers = response.value("headers", json::object());
            CHECK_EQUAL(answer->is_replayed, headers.contains("idempotent-replayed"));
        } else {
            CHECK(!answer);
            const auto& error = answer.error();
            CHECK(error.code == revisit::Code::problem);
            json faults = json::array();
            for (const auto& fault : error.faults) faults.push_back({{"pointer", fault.pointer}, {"detail", fault.detail}, {"got", fault.got}, {"limit", fault.limit}});
            const json found{{"status", error.status}, {"code", error.problem}, {"detail", error.detail}, {"errors", faults}};
            json expected = response["body"];
            expected.erase("type");
            expected.erase("title");
            holds(found, expected, name);
        }
    }
}

static void answers_of_a_newer_server_are_read() {
    for (const auto& pair : read_all("future")) {
        const json body = pair["response"]["body"];
        StandIn stand_in([&](const HeardRequest&) { return GivenAnswer{pair["response"]["status"], body.dump(), "", false, false}; });
        revisit::Endpoint endpoint;
        endpoint.url = stand_in.url();
        auto client = revisit::Client::open(endpoint);
        CHECK_OK(client);
        auto answer = ask(*client, pair);
        CHECK_OK(answer);
        holds(plain(answer->json), body, "future");
        const auto verdict = revisit::verdict_of(std::move(answer->json));
        CHECK_OK(verdict);
        CHECK(verdict->decision == revisit::Decision::other);
        CHECK_EQUAL(verdict->verdict, body["verdict"].get<std::string>());
        CHECK_EQUAL(verdict->candidates[0].verdict, "postponed");
        CHECK_EQUAL(verdict->candidates[0].geometry, "dreamt");
        CHECK_EQUAL(verdict->reason, "a_reason_of_next_year");
    }
}

int main() {
    TEST(every_pair_holds_against_the_running_server);
    TEST(answers_of_a_newer_server_are_read);
}
