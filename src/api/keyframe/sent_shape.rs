//! The schemas of what a client may send packed. Answers, and what this program sends, have the lists.

use serde::Deserialize;
use utoipa::ToSchema;

use super::number_shape::{
    KeypointNumbers, PointNumber, PointNumberOrNone, Position, WordNumber, WordWeight,
};

/// A bag of words: two columns in parallel, in any order, each as a list or packed.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = SentBagOfWords)]
#[expect(dead_code, reason = "a schema only")]
pub struct SentBow {
    /// The words, none twice. This or `words_u32` is required.
    #[schema(max_items = 65535, value_type = Option<Vec<WordNumber>>, inline)]
    words: Option<Vec<u32>>,
    /// The words, packed: base64 of little-endian 32-bit unsigned numbers.
    #[schema(max_length = 349_520)]
    words_u32: Option<String>,
    /// Their weights, without unit; normalised to sum to one on arrival. This or `weights_f64` is required.
    #[schema(max_items = 65535, value_type = Option<Vec<WordWeight>>, inline)]
    weights: Option<Vec<f64>>,
    /// Their weights, packed: base64 of little-endian 64-bit floats.
    #[schema(max_length = 699_040)]
    weights_f64: Option<String>,
    /// Whose words these are, such as a vocabulary's fingerprint. Words of two vocabularies do not go into one map.
    #[schema(max_length = 128)]
    vocabulary: Option<String>,
}

/// Binary features: columns in parallel, each as a list or packed.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = SentFeatures)]
#[expect(dead_code, reason = "a schema only")]
pub struct SentFeatures {
    /// Bytes of one descriptor: 32 for ORB, 64 for BRISK.
    #[schema(minimum = 8, maximum = 512, multiple_of = 8)]
    descriptor_bytes: u32,
    /// The descriptors one after the other, in base64.
    #[schema(max_length = 13_653_336)]
    descriptors: String,
    /// One for each descriptor: `[u,v]`, `[u,v,octave]` or `[u,v,octave,angle_deg]`, in pixels, pyramid level and degrees. This
    /// or `keypoints_f32` is required.
    #[schema(max_items = 20000, value_type = Option<Vec<KeypointNumbers>>, inline)]
    keypoints: Option<Vec<Vec<f64>>>,
    /// The keypoints, packed: base64 of little-endian 32-bit floats, u, v, octave and angle of each; an angle that is not a
    /// number is none.
    #[schema(max_length = 426_668)]
    keypoints_f32: Option<String>,
    /// The map point that each feature observes, -1 for none; left out if none does.
    #[schema(max_items = 20000, value_type = Option<Vec<PointNumberOrNone>>, inline)]
    map_points: Option<Vec<i64>>,
    /// The map points, packed: base64 of little-endian 64-bit signed numbers.
    #[schema(max_length = 213_336)]
    map_points_i64: Option<String>,
}

/// Positions of map points: two columns in parallel, each as a list or packed.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = SentMapPoints)]
#[expect(dead_code, reason = "a schema only")]
pub struct SentPoints {
    /// The points' numbers in their session, none twice. This or `ids_i64` is required.
    #[schema(max_items = 100_000, value_type = Option<Vec<PointNumber>>, inline)]
    ids: Option<Vec<i64>>,
    /// The points' numbers, packed: base64 of little-endian 64-bit signed numbers.
    #[schema(max_length = 1_066_668)]
    ids_i64: Option<String>,
    /// `[x,y,z]` of each in the session's frame, in metres. This or `positions_f64` is required.
    #[schema(max_items = 100_000, value_type = Option<Vec<Position>>, inline)]
    positions: Option<Vec<[f64; 3]>>,
    /// The positions, packed: base64 of little-endian 64-bit floats, x, y and z of each.
    #[schema(max_length = 3_200_000)]
    positions_f64: Option<String>,
}
