// A keyframe as a robot sends it, and the check that refuses a bad one at once.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry.hpp"
#include "number_text.hpp"
#include "result.hpp"

namespace revisit {

struct Stamp {
    std::int64_t sec = 0;
    std::uint32_t nanosec = 0;

    /// From seconds, as hosts keep them. Times before 1970 round down.
    static Stamp of_seconds(double seconds) noexcept {
        constexpr double in_a_second = 1e9;
        if (!std::isfinite(seconds) || std::fabs(seconds) > 1e15) return {std::numeric_limits<std::int64_t>::max(), 0};
        const double whole = std::floor(seconds);
        auto nanosec = static_cast<std::int64_t>(std::llround((seconds - whole) * in_a_second));
        const bool carries = nanosec >= 1'000'000'000;
        return {static_cast<std::int64_t>(whole) + (carries ? 1 : 0), static_cast<std::uint32_t>(carries ? 0 : nanosec)};
    }
};

/// An undistorted pinhole, in pixels. Keypoints and boxes are undistorted too.
struct Camera {
    double fx = 0, fy = 0, cx = 0, cy = 0;
    int width = 0, height = 0;
};

/// A bag of words in parallel columns, in any order; the server normalises the weights.
struct Bow {
    std::vector<std::uint32_t> words;
    std::vector<double> weights;
    std::string vocabulary;
};

struct Keypoint {
    float u = 0, v = 0;
    int octave = 0;
    /// Degrees; not a number where the detector gives none.
    float angle_deg = std::numeric_limits<float>::quiet_NaN();
};

struct Features {
    /// Bytes of one descriptor, a multiple of 8: 32 for ORB.
    int descriptor_bytes = 32;
    std::vector<std::uint8_t> descriptors;
    std::vector<Keypoint> keypoints;
    /// The map point that each feature observes, -1 for none; empty if none does.
    std::vector<std::int64_t> map_points;
};

/// Positions of new or moved points, `[x,y,z]` in the session's frame, in metres.
struct MapPoints {
    std::vector<std::int64_t> ids;
    std::vector<Vector3> positions;
};

struct Covisible {
    std::string keyframe;
    std::uint32_t shared = 0;
};

struct Detection {
    std::string class_name;
    double confidence = 0;
    /// x0, y0, x1, y1 in pixels.
    std::array<double, 4> box{0, 0, 0, 0};
    std::vector<std::int64_t> map_points;
    std::optional<Vector3> position;
    std::string text;
    std::string description;
    /// A PNG or JPEG, as bytes.
    std::vector<std::uint8_t> crop;
    /// Whether nothing measured the distance of `position`.
    bool is_range_assumed = false;
};

struct Keyframe {
    std::string id;
    std::string session = "default";
    Stamp stamp;
    Pose map_from_camera;
    std::optional<Camera> camera;
    Bow bow;
    /// Unit vector of gravity in the camera frame, where an IMU knows it.
    std::optional<Vector3> gravity;
    /// Height by a barometer, in metres above a level of the session's own.
    std::optional<double> height_m;
    Features features;
    MapPoints map_points;
    /// Points observed beyond those of `features.map_points`.
    std::vector<std::int64_t> observes;
    /// Covisible keyframes. An empty list says that there are none. Absent, and without map points, those near along the drive are.
    std::optional<std::vector<Covisible>> covisible;
    std::vector<Detection> detections;
};

namespace limits {
// As the server's API document has them.
constexpr std::size_t id_chars = 128;
constexpr std::size_t words = 65'535;
constexpr std::size_t features = 20'000;
constexpr std::size_t map_points = 100'000;
constexpr std::size_t covisible = 10'000;
constexpr std::size_t detections = 500;
constexpr std::size_t corrections = 100'000;
/// Of one change of observations: fused points, and as many culled ones.
constexpr std::size_t gone_points = 10'000;
constexpr std::size_t changed_keyframes = 1'000;
constexpr std::size_t text_chars = 4096;
constexpr std::size_t class_chars = 64;
constexpr std::size_t crop_bytes = std::size_t{4} << 20;
constexpr int descriptor_bytes = 512;
constexpr int max_octave = 63;
constexpr int image_side_px = 1'000'000;
constexpr double coordinate_m = 1e9;
constexpr double pixel = 1e6;
constexpr double height_m = 1e5;
constexpr double weight = 1e30;
constexpr double quaternion_norm_error = 0.01;
constexpr double gravity_norm_error = 1e-3;
constexpr double angle_deg = 360;
constexpr std::int64_t first_sec = -62'135'596'800;
constexpr std::int64_t last_sec = 253'402'300'799;
}  // namespace limits

namespace detail {

/// Collects the first fault; later ones are not looked for.
class Checker {
public:
    template <class... Parts>
    bool refuse(const char* why, const Parts&... field) {
        if (error_.code == Code::ok) {
            error_ = Error(Code::invalid, std::string(), why);
            (append(field), ...);
        }
        return false;
    }
    template <class... Parts>
    bool number(double value, double limit, const Parts&... field) {
        if (!std::isfinite(value)) return refuse("not a finite number", field...);
        if (std::fabs(value) > limit) return refuse("beyond the limit", field...);
        return true;
    }
    template <class... Parts>
    bool count(std::size_t value, std::size_t limit, const Parts&... field) {
        return value <= limit || refuse("too many items", field...);
    }
    template <class... Parts>
    bool text(std::string_view value, std::size_t limit, const Parts&... field) {
        if (value.size() > limit) return refuse("too long", field...);
        return is_utf8(value) || refuse("not UTF-8", field...);
    }
    /// An id of the contract: `[A-Za-z0-9._:-]{1,128}`, and no path step of only dots.
    template <class... Parts>
    bool id(std::string_view value, const Parts&... field) {
        if (value.empty() || value.size() > limits::id_chars || value == "." || value == "..") return refuse("an id has 1 to 128 characters", field...);
        for (const char c : value) {
            const bool allowed = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == ':' || c == '-';
            if (!allowed) return refuse("an id has letters, digits and . _ : -", field...);
        }
        return true;
    }
    template <class... Parts>
    bool position(const Vector3& value, const Parts&... field) {
        return number(value[0], limits::coordinate_m, field...) && number(value[1], limits::coordinate_m, field...) && number(value[2], limits::coordinate_m, field...);
    }
    template <class... Parts>
    bool pose(const Pose& value, const Parts&... field) {
        if (!position(value.translation, field..., "/translation")) return false;
        const auto& q = value.rotation;
        const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
        // A NaN fails it too.
        return std::fabs(norm - 1) <= limits::quaternion_norm_error || refuse("not a unit quaternion", field..., "/rotation");
    }
    template <class... Parts>
    bool points(const std::vector<std::int64_t>& ids, std::size_t limit, std::int64_t least, const Parts&... field) {
        if (!count(ids.size(), limit, field...)) return false;
        for (std::size_t i = 0; i < ids.size(); ++i)
            if (ids[i] < least) return refuse("a point's number is not negative", field..., "/", i);
        return true;
    }

    Status status() const { return error_.code == Code::ok ? Status() : Status(error_); }

private:
    void append(const char* part) { error_.field += part; }
    void append(std::size_t part) { error_.field += std::to_string(part); }

    Error error_{Code::ok};
};

inline bool check_features(Checker& checker, const Features& features) {
    if (features.keypoints.empty() && features.descriptors.empty())
        return features.map_points.empty() || checker.refuse("there are no keypoints for them", "/features/map_points");
    const auto bytes = features.descriptor_bytes;
    if (bytes < 8 || bytes > limits::descriptor_bytes || bytes % 8 != 0) return checker.refuse("a multiple of 8, from 8 to 512", "/features/descriptor_bytes");
    if (!checker.count(features.keypoints.size(), limits::features, "/features/keypoints")) return false;
    if (features.descriptors.size() != features.keypoints.size() * static_cast<std::size_t>(bytes))
        return checker.refuse("its size is not descriptor_bytes for each keypoint", "/features/descriptors");
    if (!features.map_points.empty() && features.map_points.size() != features.keypoints.size())
        return checker.refuse("not one for each keypoint", "/features/map_points");
    for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
        const auto& at = features.keypoints[i];
        if (!checker.number(at.u, limits::pixel, "/features/keypoints/", i) || !checker.number(at.v, limits::pixel, "/features/keypoints/", i)) return false;
        if (at.octave < 0 || at.octave > limits::max_octave) return checker.refuse("an octave is 0 to 63", "/features/keypoints/", i);
        if (!std::isnan(at.angle_deg) && !(std::fabs(at.angle_deg) <= limits::angle_deg)) return checker.refuse("an angle is -360 to 360 degrees", "/features/keypoints/", i);
    }
    return checker.points(features.map_points, limits::features, -1, "/features/map_points");
}

inline bool check_map_points(Checker& checker, const MapPoints& points, std::size_t limit) {
    if (points.ids.size() != points.positions.size()) return checker.refuse("not one for each id", "/map_points/positions");
    if (!checker.points(points.ids, limit, 0, "/map_points/ids")) return false;
    for (std::size_t i = 0; i < points.positions.size(); ++i)
        if (!checker.position(points.positions[i], "/map_points/positions/", i)) return false;
    return true;
}

inline bool check_detection(Checker& checker, const Detection& detection, std::size_t i) {
    const char* at = "/detections/";
    if (detection.class_name.empty()) return checker.refuse("required", at, i, "/class");
    if (!checker.text(detection.class_name, limits::class_chars, at, i, "/class")) return false;
    if (!(detection.confidence >= 0 && detection.confidence <= 1)) return checker.refuse("a confidence is 0 to 1", at, i, "/confidence");
    for (const double side : detection.box)
        if (!checker.number(side, limits::pixel, at, i, "/box")) return false;
    if (!(detection.box[0] <= detection.box[2] && detection.box[1] <= detection.box[3])) return checker.refuse("x0,y0 lies beyond x1,y1", at, i, "/box");
    if (!checker.points(detection.map_points, limits::map_points, 0, at, i, "/map_points")) return false;
    if (detection.position && !checker.position(*detection.position, at, i, "/position")) return false;
    return checker.text(detection.text, limits::text_chars, at, i, "/text") && checker.text(detection.description, limits::text_chars, at, i, "/description") &&
           checker.count(detection.crop.size(), limits::crop_bytes, at, i, "/crop");
}

inline bool check_bow(Checker& checker, const Bow& bow) {
    if (!checker.count(bow.words.size(), limits::words, "/bow/words")) return false;
    if (bow.words.size() != bow.weights.size()) return checker.refuse("not one for each word", "/bow/weights");
    for (std::size_t i = 0; i < bow.weights.size(); ++i)
        if (!(bow.weights[i] >= 0 && bow.weights[i] <= limits::weight)) return checker.refuse("a weight is finite and not negative", "/bow/weights/", i);
    return checker.text(bow.vocabulary, limits::id_chars, "/bow/vocabulary");
}

inline bool check_camera(Checker& checker, const Camera& camera) {
    if (!(camera.fx > 0) || !(camera.fy > 0)) return checker.refuse("a focal length is positive", "/camera/fx");
    if (camera.width < 1 || camera.height < 1 || camera.width > limits::image_side_px || camera.height > limits::image_side_px)
        return checker.refuse("an image has 1 to 1000000 pixels a side", "/camera/width");
    return checker.number(camera.fx, limits::pixel, "/camera/fx") && checker.number(camera.fy, limits::pixel, "/camera/fy") &&
           checker.number(camera.cx, limits::pixel, "/camera/cx") && checker.number(camera.cy, limits::pixel, "/camera/cy");
}

}  // namespace detail

/// Refuses what the server would refuse: sizes that do not fit, numbers that are not finite. The error names the field.
inline Status check(const Keyframe& keyframe) noexcept {
    return detail::guarded([&]() -> Status {
        detail::Checker checker;
        bool good = checker.id(keyframe.id, "/id") && checker.id(keyframe.session, "/session");
        if (good && (keyframe.stamp.sec < limits::first_sec || keyframe.stamp.sec > limits::last_sec)) good = checker.refuse("no time", "/stamp/sec");
        if (good && keyframe.stamp.nanosec > 999'999'999) good = checker.refuse("0 to 999999999", "/stamp/nanosec");
        good = good && checker.pose(keyframe.map_from_camera, "/pose");
        if (good && keyframe.camera) good = detail::check_camera(checker, *keyframe.camera);
        good = good && detail::check_bow(checker, keyframe.bow);
        if (good && keyframe.gravity) {
            const auto& g = *keyframe.gravity;
            const double norm = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
            if (!(std::fabs(norm - 1) <= limits::gravity_norm_error)) good = checker.refuse("not a unit vector", "/gravity");
        }
        good = good && detail::check_features(checker, keyframe.features) && detail::check_map_points(checker, keyframe.map_points, limits::map_points) &&
               checker.points(keyframe.observes, limits::map_points, 0, "/observes") && checker.count(keyframe.covisible ? keyframe.covisible->size() : 0, limits::covisible, "/covisible");
        if (good && keyframe.height_m) good = checker.number(*keyframe.height_m, limits::height_m, "/height_m");
        for (std::size_t i = 0; good && keyframe.covisible && i < keyframe.covisible->size(); ++i) good = checker.id((*keyframe.covisible)[i].keyframe, "/covisible/", i, "/keyframe");
        good = good && checker.count(keyframe.detections.size(), limits::detections, "/detections");
        for (std::size_t i = 0; good && i < keyframe.detections.size(); ++i) good = detail::check_detection(checker, keyframe.detections[i], i);
        return checker.status();
    });
}

}  // namespace revisit
