// A keyframe's body. Each long column is written in its shortest form, as a list or packed: the server makes the same facts of all.
#pragma once

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "base64.hpp"
#include "bow_units.hpp"
#include "keyframe.hpp"
#include "number_text.hpp"

namespace revisit {

/// Decimals kept of what is measured. More cost bytes and say nothing: a corner is found within a tenth of a pixel.
struct Precision {
    int keypoint_decimals = 2;
    /// 0.1 mm; for a map without a metric scale, 1/10,000 of its unit.
    int position_decimals = 4;
};

namespace detail {

/// Writes the members of an object, with commas between them.
class ObjectWriter {
public:
    explicit ObjectWriter(std::string& out) : out_(out) { out_ += '{'; }
    std::string& name(const char* name) {
        if (!first_) out_ += ',';
        first_ = false;
        out_ += '"';
        out_ += name;
        out_ += "\":";
        return out_;
    }
    void text(const char* member, const std::string& value) { append_string(name(member), value); }
    void close() { out_ += '}'; }

private:
    std::string& out_;
    bool first_ = true;
};

/// Writes integers always as a list: for lists that have no packed form, or never a shorter one.
inline void append_id_list(std::string& out, const std::vector<std::int64_t>& ids) {
    out += '[';
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (i > 0) out += ',';
        append_integer(out, ids[i]);
    }
    out += ']';
}

/// Writes a column of integers as `name`, or packed as `packed`.
template <class T>
void append_integers(ObjectWriter& object, const char* name, const char* packed, const std::vector<T>& values) {
    // With a comma or bracket for each.
    std::size_t listed = values.size();
    for (const T value : values) listed += integer_chars(static_cast<std::int64_t>(value));
    if (listed <= base64_chars(values.size() * sizeof(T))) {
        std::string& out = object.name(name);
        out += '[';
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (i > 0) out += ',';
            append_integer(out, static_cast<std::int64_t>(values[i]));
        }
        out += ']';
        return;
    }
    std::string& out = object.name(packed);
    out += '"';
    Base64Writer writer(out);
    for (const T value : values) writer.number(value);
    writer.finish();
    out += '"';
}

inline void append_position(std::string& out, const Vector3& position, int decimals) {
    out += '[';
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (axis > 0) out += ',';
        append_decimals(out, position[axis], decimals);
    }
    out += ']';
}

inline void append_positions(std::string& out, const std::vector<Vector3>& positions, int decimals) {
    out += '[';
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (i > 0) out += ',';
        append_position(out, positions[i], decimals);
    }
    out += ']';
}

inline void append_vector(std::string& out, const Vector3& v) {
    out += "{\"x\":";
    append_number(out, v[0]);
    out += ",\"y\":";
    append_number(out, v[1]);
    out += ",\"z\":";
    append_number(out, v[2]);
    out += '}';
}

inline void append_pose(std::string& out, const Pose& pose) {
    out += "{\"translation\":";
    append_vector(out, pose.translation);
    out += ",\"rotation\":{\"x\":";
    // A float's error in the norm goes through the server's tolerance; normalised, retries stay the same too.
    const Quaternion q = normalized(pose.rotation);
    append_number(out, q.x);
    out += ",\"y\":";
    append_number(out, q.y);
    out += ",\"z\":";
    append_number(out, q.z);
    out += ",\"w\":";
    append_number(out, q.w);
    out += "}}";
}

/// Writes weights as they are, or in the server's units, whichever is shorter: it normalises both to the same vector.
inline void append_weights(std::string& out, const Bow& bow) {
    const std::size_t begin = out.size();
    append_id_list(out, bow_units(bow));
    const std::size_t longest = out.size() - begin;
    std::string listed = "[";
    for (std::size_t i = 0; i < bow.weights.size() && listed.size() < longest; ++i) {
        if (i > 0) listed += ',';
        append_number(listed, bow.weights[i]);
    }
    if ((listed += ']').size() < longest) out.replace(begin, longest, listed);
}

inline void append_bow(std::string& out, const Bow& bow) {
    ObjectWriter object(out);
    append_integers(object, "words", "words_u32", bow.words);
    append_weights(object.name("weights"), bow);
    if (!bow.vocabulary.empty()) object.text("vocabulary", bow.vocabulary);
    object.close();
}

inline void append_features(std::string& out, const Features& features, int decimals) {
    ObjectWriter object(out);
    append_integer(object.name("descriptor_bytes"), features.descriptor_bytes);
    object.name("descriptors") += '"';
    Base64Writer descriptors(out);
    descriptors.bytes(features.descriptors.data(), features.descriptors.size());
    descriptors.finish();
    out += '"';
    object.name("keypoints_f32") += '"';
    Base64Writer keypoints(out);
    for (const auto& at : features.keypoints) {
        // Rounded before packing: the low bits that say nothing become alike, and compress.
        keypoints.number(static_cast<float>(rounded(at.u, decimals)));
        keypoints.number(static_cast<float>(rounded(at.v, decimals)));
        keypoints.number(static_cast<float>(at.octave));
        keypoints.number(std::isnan(at.angle_deg) ? at.angle_deg : static_cast<float>(rounded(at.angle_deg, decimals)));
    }
    keypoints.finish();
    out += '"';
    if (!features.map_points.empty()) append_integers(object, "map_points", "map_points_i64", features.map_points);
    object.close();
}

inline void append_map_points(std::string& out, const MapPoints& points, int decimals) {
    ObjectWriter object(out);
    append_integers(object, "ids", "ids_i64", points.ids);
    append_positions(object.name("positions"), points.positions, decimals);
    object.close();
}

inline void append_covisible(std::string& out, const std::vector<Covisible>& covisible) {
    out += '[';
    for (std::size_t i = 0; i < covisible.size(); ++i) {
        if (i > 0) out += ',';
        ObjectWriter object(out);
        object.text("keyframe", covisible[i].keyframe);
        append_integer(object.name("shared"), covisible[i].shared);
        object.close();
    }
    out += ']';
}

inline void append_detection(std::string& out, const Detection& detection, int decimals) {
    ObjectWriter object(out);
    object.text("class", detection.class_name);
    append_number(object.name("confidence"), detection.confidence);
    object.name("box") += '[';
    for (std::size_t i = 0; i < detection.box.size(); ++i) {
        if (i > 0) out += ',';
        append_number(out, detection.box[i]);
    }
    out += ']';
    if (!detection.map_points.empty()) append_id_list(object.name("map_points"), detection.map_points);
    if (detection.position) append_position(object.name("position"), *detection.position, decimals);
    if (!detection.text.empty()) object.text("text", detection.text);
    if (!detection.description.empty()) object.text("description", detection.description);
    if (!detection.crop.empty()) {
        object.name("crop") += '"';
        Base64Writer crop(out);
        crop.bytes(detection.crop.data(), detection.crop.size());
        crop.finish();
        out += '"';
    }
    if (detection.is_range_assumed) object.text("range", "assumed");
    object.close();
}

inline void append_keyframe(std::string& out, const Keyframe& keyframe, const Precision& precision) {
    // Base64 of the descriptors dominates; what follows is small against one growth of the string.
    out.reserve(out.size() + base64_chars(keyframe.features.descriptors.size()) + keyframe.features.keypoints.size() * 32 + keyframe.bow.words.size() * 20 + 1024);
    ObjectWriter object(out);
    object.text("session", keyframe.session);
    append_integer(object.name("stamp") += "{\"sec\":", keyframe.stamp.sec);
    append_integer(out += ",\"nanosec\":", keyframe.stamp.nanosec);
    out += '}';
    append_pose(object.name("pose"), keyframe.map_from_camera);
    if (keyframe.camera) {
        const auto& camera = *keyframe.camera;
        append_number(object.name("camera") += "{\"fx\":", camera.fx);
        append_number(out += ",\"fy\":", camera.fy);
        append_number(out += ",\"cx\":", camera.cx);
        append_number(out += ",\"cy\":", camera.cy);
        append_integer(out += ",\"width\":", camera.width);
        append_integer(out += ",\"height\":", camera.height);
        out += '}';
    }
    if (!keyframe.bow.words.empty()) append_bow(object.name("bow"), keyframe.bow);
    if (keyframe.gravity) {
        const auto& g = *keyframe.gravity;
        object.name("gravity") += '[';
        append_number(out, g[0]);
        append_number(out += ',', g[1]);
        append_number(out += ',', g[2]);
        out += ']';
    }
    if (keyframe.height_m) append_number(object.name("height_m"), *keyframe.height_m);
    if (!keyframe.features.keypoints.empty()) append_features(object.name("features"), keyframe.features, precision.keypoint_decimals);
    if (!keyframe.map_points.ids.empty()) append_map_points(object.name("map_points"), keyframe.map_points, precision.position_decimals);
    if (!keyframe.observes.empty()) append_integers(object, "observes", "observes_i64", keyframe.observes);
    if (keyframe.covisible) append_covisible(object.name("covisible"), *keyframe.covisible);
    if (!keyframe.detections.empty()) {
        object.name("detections") += '[';
        for (std::size_t i = 0; i < keyframe.detections.size(); ++i) {
            if (i > 0) out += ',';
            append_detection(out, keyframe.detections[i], precision.position_decimals);
        }
        out += ']';
    }
    object.close();
}

}  // namespace detail

/// The body of a keyframe, which has no `id`: that is in the path.
inline Result<std::string> to_json(const Keyframe& keyframe, const Precision& precision = Precision()) noexcept {
    return detail::guarded([&]() -> Result<std::string> {
        std::string out;
        detail::append_keyframe(out, keyframe, precision);
        return out;
    });
}

}  // namespace revisit
