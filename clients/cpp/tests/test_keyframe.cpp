// Keyframes: bad ones are refused with the field's name, good ones come back from their bytes, and these are few.
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <nlohmann/json.hpp>
#include <revisit/revisit.hpp>

#include "check.hpp"
#include "samples.hpp"

using namespace revisit;

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

static void a_bad_keyframe_is_refused_with_its_field() {
    struct Case {
        const char* field;
        std::function<void(Keyframe&)> spoil;
    };
    const Case cases[] = {
        {"/id", [](Keyframe& k) { k.id = "a b"; }},
        {"/id", [](Keyframe& k) { k.id = ""; }},
        {"/id", [](Keyframe& k) { k.id = ".."; }},
        {"/id", [](Keyframe& k) { k.id = std::string(129, 'a'); }},
        {"/session", [](Keyframe& k) { k.session = "a/b"; }},
        {"/stamp/sec", [](Keyframe& k) { k.stamp = Stamp::of_seconds(nan_value); }},
        {"/stamp/nanosec", [](Keyframe& k) { k.stamp.nanosec = 1'000'000'000; }},
        {"/pose/translation", [](Keyframe& k) { k.map_from_camera.translation[1] = nan_value; }},
        {"/pose/translation", [](Keyframe& k) { k.map_from_camera.translation[1] = 2e9; }},
        {"/pose/rotation", [](Keyframe& k) { k.map_from_camera.rotation = {0, 0, 0, 0}; }},
        {"/pose/rotation", [](Keyframe& k) { k.map_from_camera.rotation.x = nan_value; }},
        {"/camera/fx", [](Keyframe& k) { k.camera->fx = 0; }},
        {"/camera/cx", [](Keyframe& k) { k.camera->cx = infinite; }},
        {"/camera/width", [](Keyframe& k) { k.camera->width = 0; }},
        {"/bow/weights", [](Keyframe& k) { k.bow.weights.pop_back(); }},
        {"/bow/weights/3", [](Keyframe& k) { k.bow.weights[3] = -1; }},
        {"/bow/weights/3", [](Keyframe& k) { k.bow.weights[3] = nan_value; }},
        {"/gravity", [](Keyframe& k) { k.gravity = Vector3{0, 0, 0}; }},
        {"/height_m", [](Keyframe& k) { k.height_m = 100'001; }},
        {"/height_m", [](Keyframe& k) { k.height_m = nan_value; }},
        {"/features/descriptor_bytes", [](Keyframe& k) { k.features.descriptor_bytes = 33; }},
        {"/features/descriptors", [](Keyframe& k) { k.features.descriptors.pop_back(); }},
        {"/features/map_points", [](Keyframe& k) { k.features.map_points.pop_back(); }},
        {"/features/map_points/2", [](Keyframe& k) { k.features.map_points[2] = -2; }},
        {"/features/keypoints/17", [](Keyframe& k) { k.features.keypoints[17].v = std::numeric_limits<float>::infinity(); }},
        {"/features/keypoints/17", [](Keyframe& k) { k.features.keypoints[17].octave = 64; }},
        {"/features/keypoints/17", [](Keyframe& k) { k.features.keypoints[17].angle_deg = 361; }},
        {"/map_points/positions", [](Keyframe& k) { k.map_points.positions.pop_back(); }},
        {"/map_points/positions/5", [](Keyframe& k) { k.map_points.positions[5][2] = nan_value; }},
        {"/map_points/ids/5", [](Keyframe& k) { k.map_points.ids[5] = -1; }},
        {"/observes/0", [](Keyframe& k) { k.observes = {-1}; }},
        {"/covisible/0/keyframe", [](Keyframe& k) { k.covisible = std::vector<Covisible>{{"", 3}}; }},
        {"/detections/0/class", [](Keyframe& k) { k.detections.emplace_back(); }},
        {"/detections/0/confidence", [](Keyframe& k) { k.detections = samples::plate("a", 0, 0, "1").detections, k.detections[0].confidence = 1.5; }},
        {"/detections/0/box", [](Keyframe& k) { k.detections = samples::plate("a", 0, 0, "1").detections, k.detections[0].box[2] = 1; }},
        {"/detections/0/text", [](Keyframe& k) { k.detections = samples::plate("a", 0, 0, "\xff").detections; }},
        {"/detections/0/position", [](Keyframe& k) { k.detections = samples::plate("a", nan_value, 0, "1").detections; }},
    };
    const Keyframe good = samples::keyframe(1, 50, 20, 10);
    CHECK_OK(check(good));
    for (const auto& one : cases) {
        Keyframe keyframe = good;
        one.spoil(keyframe);
        const auto status = check(keyframe);
        CHECK(!status);
        CHECK_EQUAL(status.error().field, one.field);
        CHECK(status.error().code == Code::invalid);
    }
}

static std::vector<unsigned char> bytes_of(const std::string& text) {
    std::vector<unsigned char> out;
    unsigned bits = 0;
    int held = 0;
    for (const char c : text) {
        if (c == '=') break;
        const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        bits = (bits << 6 | static_cast<unsigned>(alphabet.find(c))) & 0xffffff;
        held += 6;
        if (held >= 8) out.push_back(static_cast<unsigned char>(bits >> (held -= 8)));
    }
    return out;
}

template <class T>
static std::vector<T> column(const nlohmann::json& object, const char* name, const char* packed) {
    if (object.contains(name)) return object[name].get<std::vector<T>>();
    const auto bytes = bytes_of(object[packed].get<std::string>());
    std::vector<T> out(bytes.size() / sizeof(T));
    std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
    return out;
}

static void a_keyframe_comes_back_from_its_bytes() {
    for (unsigned seed = 1; seed < 20; ++seed) {
        auto keyframe = samples::keyframe(seed, seed * 7, seed * 3, seed);
        keyframe.detections = samples::plate("x", 1.5, 2, "a \"quoted\"\n\xc3\xa4").detections;
        // Large numbers, so that packed columns are shorter.
        if (seed % 2 == 0) keyframe.observes = {std::numeric_limits<std::int64_t>::max(), 1'000'000'000'000'000};
        const auto text = to_json(keyframe);
        CHECK_OK(text);
        const auto json = nlohmann::json::parse(*text);
        CHECK_EQUAL(json["session"], "robot-7");
        CHECK_EQUAL(json["pose"]["translation"]["y"].get<double>(), 0.123456789);
        CHECK(column<std::uint32_t>(json["bow"], "words", "words_u32") == keyframe.bow.words);
        const auto units = json["bow"]["weights"].get<std::vector<std::int64_t>>();
        CHECK_EQUAL(std::accumulate(units.begin(), units.end(), std::int64_t{0}), std::int64_t{1} << 31);
        CHECK(bytes_of(json["features"]["descriptors"]) == keyframe.features.descriptors);
        CHECK(column<std::int64_t>(json["features"], "map_points", "map_points_i64") == keyframe.features.map_points);
        const auto keypoints = column<float>(json["features"], "keypoints", "keypoints_f32");
        CHECK_EQUAL(keypoints.size(), 4 * keyframe.features.keypoints.size());
        for (std::size_t i = 0; i < keyframe.features.keypoints.size(); ++i) {
            const auto& at = keyframe.features.keypoints[i];
            CHECK(std::fabs(keypoints[4 * i] - at.u) < 0.0051);
            CHECK(std::fabs(keypoints[4 * i + 1] - at.v) < 0.0051);
            CHECK_EQUAL(keypoints[4 * i + 2], static_cast<float>(at.octave));
        }
        CHECK(column<std::int64_t>(json["map_points"], "ids", "ids_i64") == keyframe.map_points.ids);
        for (std::size_t i = 0; i < keyframe.map_points.ids.size(); ++i)
            for (std::size_t axis = 0; axis < 3; ++axis)
                CHECK(std::fabs(json["map_points"]["positions"][i][axis].get<double>() - keyframe.map_points.positions[i][axis]) < 0.000051);
        if (seed % 2 == 0) CHECK(column<std::int64_t>(json, "observes", "observes_i64") == keyframe.observes);
        CHECK_EQUAL(json["detections"][0]["text"], "a \"quoted\"\n\xc3\xa4");
    }
}

// What a robot sends in each second of the day: a map point on every feature costs more than on seven of ten, as does a pose of all digits.
static void a_keyframe_of_1000_features_is_below_90_kb() {
    const auto size_of = [](const char* what, const Keyframe& keyframe) {
        const auto text = to_json(keyframe);
        CHECK_OK(text);
        std::string smaller = *text;
        const bool is_compressed = detail::compress(smaller);
        std::printf("  1,000 ORB features, %s, 500 words, 300 positions: %zu bytes, as zstd %zu\n", what, text->size(), is_compressed ? smaller.size() : 0);
        std::string features, bow, points;
        detail::append_features(features, keyframe.features, 2);
        detail::append_bow(bow, keyframe.bow);
        detail::append_map_points(points, keyframe.map_points, 4);
        std::printf("    descriptors %zu, keypoints %zu, their points %zu; words and weights %zu; positions and ids %zu; the rest %zu\n", detail::base64_chars(keyframe.features.descriptors.size()),
                    detail::base64_chars(16 * keyframe.features.keypoints.size()), features.size() - detail::base64_chars(keyframe.features.descriptors.size()) - detail::base64_chars(16 * keyframe.features.keypoints.size()),
                    bow.size(), points.size(), text->size() - features.size() - bow.size() - points.size());
        CHECK(text->size() < 90'000);
    };
    auto keyframe = samples::keyframe(4000);
    size_of("700 with a point of seven digits", keyframe);
    for (std::size_t i = 0; i < keyframe.features.map_points.size(); ++i) keyframe.features.map_points[i] = static_cast<std::int64_t>(4000 * 300 + i);
    keyframe.map_from_camera = {{40.123456789012345, -3.123456789012345, 1.123456789012345}, normalized({0.1, 0.2, 0.3, 0.9})};
    size_of("each with a point", keyframe);
}

static void weights_in_units_sum_to_the_whole_and_come_back_unchanged() {
    std::mt19937 chance(31);
    for (int round = 0; round < 300; ++round) {
        Bow bow;
        const std::size_t words = chance() % 80;
        for (std::size_t i = 0; i < words; ++i) {
            bow.words.push_back(static_cast<std::uint32_t>((i * 7919) % 100'003));
            const double exponent = std::uniform_real_distribution<double>(round % 2 == 0 ? -3 : -300, round % 2 == 0 ? 1 : 30)(chance);
            bow.weights.push_back(chance() % 5 == 0 ? 0 : std::pow(10, exponent));
        }
        const auto units = detail::bow_units(bow);
        const bool is_empty = std::all_of(bow.weights.begin(), bow.weights.end(), [](double weight) { return weight == 0; });
        CHECK_EQUAL(std::accumulate(units.begin(), units.end(), std::int64_t{0}), is_empty ? 0 : detail::whole_bow);
        for (std::size_t i = 0; i < words; ++i) CHECK_EQUAL(units[i] > 0, bow.weights[i] > 0);
        Bow again = bow;
        again.weights.assign(units.begin(), units.end());
        CHECK(detail::bow_units(again) == units);
    }
    // A short weight stays as it is.
    std::string out;
    detail::append_bow(out, {{3, 17, 42}, {1, 1, 0.5}, ""});
    CHECK_EQUAL(out, R"({"words":[3,17,42],"weights":[1,1,0.5]})");
}

static void numbers_are_written_as_they_are_meant() {
    const auto decimals = [](double value, int places) {
        std::string out;
        detail::append_decimals(out, value, places);
        return out;
    };
    CHECK_EQUAL(decimals(1.25, 4), "1.25");
    CHECK_EQUAL(decimals(-0.00001, 4), "0");
    CHECK_EQUAL(decimals(100, 2), "100");
    CHECK_EQUAL(decimals(100, 0), "100");
    CHECK_EQUAL(decimals(0.125, 2), "0.12");
    CHECK_EQUAL(decimals(1e300, 2), "1e+300");
    CHECK_EQUAL(Stamp::of_seconds(1.9999999999).sec, 2);
    CHECK_EQUAL(Stamp::of_seconds(-0.25).sec, -1);
    CHECK_EQUAL(Stamp::of_seconds(-0.25).nanosec, 750'000'000u);
}

using Points = std::vector<std::int64_t>;

static void bad_updates_are_refused_with_their_field() {
    CHECK_EQUAL(check(PoseCorrections{"s", {"a"}, {}, {}}).error().field, "/keyframes/poses");
    CHECK_EQUAL(check(PoseCorrections{"s", {"a"}, {Pose{{0, nan_value, 0}, {}}}, {}}).error().field, "/keyframes/poses/0/translation");
    CHECK_EQUAL(check(PoseCorrections{"s", {}, {}, {{7}, {{0, 0, infinite}}}}).error().field, "/map_points/positions/0");
    CHECK_EQUAL(check(Observations{"s", {{3, 3}}, {}, {}}).error().field, "/replaced/0");
    CHECK_EQUAL(check(Observations{"s", {}, {1, -1}, {}}).error().field, "/removed/1");
    CHECK_EQUAL(check(Observations{"s", {{1, 2}, {1, 3}}, {}, {}}).error().field, "/replaced/1");
    CHECK_EQUAL(check(Observations{"s", {{1, 2}, {2, 4}, {4, 1}}, {}, {}}).error().field, "/replaced/2");
    CHECK_EQUAL(check(Observations{"s", {{1, 2}}, {1}, {}}).error().field, "/removed/0");
    CHECK_EQUAL(check(Observations{"s", {}, {3, 3}, {}}).error().field, "/removed/1");
    CHECK_EQUAL(check(Observations{"s", {}, {}, {{"a b", {}, {}}}}).error().field, "/keyframes/0/keyframe");
    CHECK_EQUAL(check(Observations{"s", {}, {}, {{"a", {}, {}}, {"a", {}, {}}}}).error().field, "/keyframes/1/keyframe");
    CHECK_EQUAL(check(Observations{"s", {{1, 2}}, {3}, {{"a", Points{2, 3}, {}}}}).error().field, "/keyframes/0/observes/1");
    CHECK_EQUAL(check(Observations{"s", {}, {}, {{"a", {}, std::vector<Covisible>{{"a", 9}}}}}).error().field, "/keyframes/0/covisible/0/keyframe");
    CHECK_OK(check(Observations{"s", {{1, 2}, {2, 3}}, {3}, {{"a", Points{}, {}}}}));
    CHECK_EQUAL(check(SessionMerge{"s", "s", {}, {}, {}}).error().field, "/into");
    CHECK_EQUAL(check(SessionMerge{"s", "t", {0, {}, {}}, {}, {}}).error().field, "/into_from_session/scale");
    CHECK_EQUAL(check(Loop{"l", "k", "", ""}).error().field, "/candidate");
    CHECK_OK(check(SessionMerge{"s", "t", {2, {}, {}}, 100, {}}));
}

int main() {
    TEST(a_bad_keyframe_is_refused_with_its_field);
    TEST(a_keyframe_comes_back_from_its_bytes);
    TEST(a_keyframe_of_1000_features_is_below_90_kb);
    TEST(weights_in_units_sum_to_the_whole_and_come_back_unchanged);
    TEST(numbers_are_written_as_they_are_meant);
    TEST(bad_updates_are_refused_with_their_field);
}
