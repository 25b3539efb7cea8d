// Poses and similarities, and how they compose. Frames are in the names: `a_from_b` maps points of b to a.
#pragma once

#include <array>
#include <cmath>

namespace revisit {

using Vector3 = std::array<double, 3>;
/// Row by row.
using Matrix3 = std::array<double, 9>;

/// A rotation. Unit length is checked where it is sent.
struct Quaternion {
    double x = 0, y = 0, z = 0, w = 1;
};

/// A rigid transform: x -> rotation * x + translation. Of a keyframe it is `map_from_camera`, in metres.
struct Pose {
    Vector3 translation{0, 0, 0};
    Quaternion rotation;
};

/// x -> scale * (rotation * x) + translation, which is also what `g2o::Sim3` does.
struct Similarity {
    double scale = 1;
    Vector3 translation{0, 0, 0};
    Quaternion rotation;
};

inline Quaternion operator*(const Quaternion& a, const Quaternion& b) noexcept {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
            a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

inline Quaternion inverse(const Quaternion& q) noexcept { return {-q.x, -q.y, -q.z, q.w}; }

inline Quaternion normalized(const Quaternion& q) noexcept {
    const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {q.x / norm, q.y / norm, q.z / norm, q.w / norm};
}

inline Vector3 rotate(const Quaternion& q, const Vector3& v) noexcept {
    // v + 2 w (u x v) + 2 u x (u x v), u the vector part.
    const Vector3 t{2 * (q.y * v[2] - q.z * v[1]), 2 * (q.z * v[0] - q.x * v[2]), 2 * (q.x * v[1] - q.y * v[0])};
    return {v[0] + q.w * t[0] + q.y * t[2] - q.z * t[1],
            v[1] + q.w * t[1] + q.z * t[0] - q.x * t[2],
            v[2] + q.w * t[2] + q.x * t[1] - q.y * t[0]};
}

/// The rotation of an orthonormal matrix. The largest component is taken first, so that no division is by nearly zero.
inline Quaternion quaternion_of(const Matrix3& m) noexcept {
    const double trace = m[0] + m[4] + m[8];
    Quaternion q;
    if (trace > 0) {
        const double s = std::sqrt(trace + 1) * 2;
        q = {(m[7] - m[5]) / s, (m[2] - m[6]) / s, (m[3] - m[1]) / s, s / 4};
    } else if (m[0] > m[4] && m[0] > m[8]) {
        const double s = std::sqrt(1 + m[0] - m[4] - m[8]) * 2;
        q = {s / 4, (m[1] + m[3]) / s, (m[2] + m[6]) / s, (m[7] - m[5]) / s};
    } else if (m[4] > m[8]) {
        const double s = std::sqrt(1 + m[4] - m[0] - m[8]) * 2;
        q = {(m[1] + m[3]) / s, s / 4, (m[5] + m[7]) / s, (m[2] - m[6]) / s};
    } else {
        const double s = std::sqrt(1 + m[8] - m[0] - m[4]) * 2;
        q = {(m[2] + m[6]) / s, (m[5] + m[7]) / s, s / 4, (m[3] - m[1]) / s};
    }
    return normalized(q);
}

inline Matrix3 matrix_of(const Quaternion& q) noexcept {
    return {1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.z * q.w), 2 * (q.x * q.z + q.y * q.w),
            2 * (q.x * q.y + q.z * q.w), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.x * q.w),
            2 * (q.x * q.z - q.y * q.w), 2 * (q.y * q.z + q.x * q.w), 1 - 2 * (q.x * q.x + q.y * q.y)};
}

inline Similarity similarity_of(const Pose& pose) noexcept { return {1, pose.translation, pose.rotation}; }

/// Drops the scale, as hosts do where they turn a corrected Sim3 into an SE3: the translation is divided by it.
inline Pose pose_of(const Similarity& camera_from_map) noexcept {
    const auto& t = camera_from_map.translation;
    const double s = camera_from_map.scale;
    return {{t[0] / s, t[1] / s, t[2] / s}, camera_from_map.rotation};
}

inline Vector3 operator*(const Similarity& a, const Vector3& point) noexcept {
    const Vector3 r = rotate(a.rotation, point);
    return {a.scale * r[0] + a.translation[0], a.scale * r[1] + a.translation[1], a.scale * r[2] + a.translation[2]};
}

inline Vector3 operator*(const Pose& a, const Vector3& point) noexcept { return similarity_of(a) * point; }

inline Similarity operator*(const Similarity& a, const Similarity& b) noexcept {
    return {a.scale * b.scale, a * b.translation, normalized(a.rotation * b.rotation)};
}

inline Pose operator*(const Pose& a, const Pose& b) noexcept {
    return {a * b.translation, normalized(a.rotation * b.rotation)};
}

inline Similarity inverse(const Similarity& a) noexcept {
    const Quaternion rotation = inverse(a.rotation);
    const Vector3 t = rotate(rotation, a.translation);
    return {1 / a.scale, {-t[0] / a.scale, -t[1] / a.scale, -t[2] / a.scale}, rotation};
}

inline Pose inverse(const Pose& a) noexcept {
    const Quaternion rotation = inverse(a.rotation);
    const Vector3 t = rotate(rotation, a.translation);
    return {{-t[0], -t[1], -t[2]}, rotation};
}

/// Where a loop puts the query: `map_from_query` after the loop, in the candidate's map.
inline Similarity corrected_map_from_query(const Pose& map_from_candidate, const Similarity& candidate_from_query) noexcept {
    return similarity_of(map_from_candidate) * candidate_from_query;
}

/// ORB-SLAM's `g2oScw` of the query: from the candidate's map to the query's camera, after the loop.
inline Similarity query_from_map(const Pose& map_from_candidate, const Similarity& candidate_from_query) noexcept {
    return inverse(corrected_map_from_query(map_from_candidate, candidate_from_query));
}

}  // namespace revisit
