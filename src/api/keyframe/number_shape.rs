//! The schemas of the numbers in a keyframe's columns, with their bounds.

use utoipa::ToSchema;

/// A map point's number, as its session counts them.
#[derive(ToSchema)]
#[schema(minimum = 0)]
pub struct PointNumber(#[expect(dead_code, reason = "a schema only")] i64);

/// A feature's map point; -1 for none.
#[derive(ToSchema)]
#[schema(minimum = -1)]
pub struct PointNumberOrNone(#[expect(dead_code, reason = "a schema only")] i64);

/// A coordinate, in metres.
#[derive(ToSchema)]
#[schema(minimum = -1e9, maximum = 1e9)]
pub struct Metres(#[expect(dead_code, reason = "a schema only")] f64);

/// An image coordinate, in pixels; it may lie outside the image.
#[derive(ToSchema)]
#[schema(minimum = -1e6, maximum = 1e6)]
pub struct Pixels(#[expect(dead_code, reason = "a schema only")] f64);

/// A word's number in its vocabulary.
#[derive(ToSchema)]
#[schema(minimum = 0, maximum = 4_294_967_295_i64)]
pub struct WordNumber(#[expect(dead_code, reason = "a schema only")] i64);

/// A word's weight, in any unit: weights are normalised to sum to one.
#[derive(ToSchema)]
#[schema(minimum = 0, maximum = 1e30)]
pub struct WordWeight(#[expect(dead_code, reason = "a schema only")] f64);

/// `[u,v]`, `[u,v,octave]` or `[u,v,octave,angle_deg]`: pixels, pyramid level (a whole number of 0 to 63), degrees.
#[derive(ToSchema)]
#[schema(min_items = 2, max_items = 4)]
pub struct KeypointNumbers(#[expect(dead_code, reason = "a schema only")] Vec<f64>);

/// A number of a unit vector, without unit.
#[derive(ToSchema)]
#[schema(minimum = -1.001, maximum = 1.001)]
pub struct DirectionPart(#[expect(dead_code, reason = "a schema only")] f64);

/// `[x,y,z]` of length one, within a thousandth.
#[derive(ToSchema)]
#[schema(min_items = 3, max_items = 3)]
pub struct Direction(
    #[expect(dead_code, reason = "a schema only")]
    #[schema(inline)]
    Vec<DirectionPart>,
);

/// `[x,y,z]`, in metres.
#[derive(ToSchema)]
#[schema(min_items = 3, max_items = 3)]
pub struct Position(
    #[expect(dead_code, reason = "a schema only")]
    #[schema(inline)]
    Vec<Metres>,
);
