//! A detection read: its box, its place and what was read of it.

use super::points::ascending;
use crate::api::decoding::read::{Decode, Node};
use crate::api::limits;
use crate::domain::counted::counted;
use crate::domain::keyframe::{Crop, Detection};
use crate::geometry::Point3;

const FIELDS: [&str; 9] =
    ["class", "confidence", "box", "map_points", "position", "range", "text", "description", "crop"];

/// The distance of `position` was guessed, say from the height that letters have as a rule.
const ASSUMED: &str = "assumed";
/// The origins of the distance of `position`.
const RANGES: [&str; 2] = ["measured", ASSUMED];

/// Reads one of `detections`.
pub fn decode(node: &Node<'_>) -> Option<Detection> {
    let body = node.object(&FIELDS)?;
    let class = body.required("class", |node| node.name(limits::CLASS_CHARS));
    let confidence = body.required("confidence", |node| node.number(limits::CONFIDENCE));
    let box_px = body.required("box", box_px);
    let map_points =
        body.optional("map_points", |node| node.list(limits::MAP_POINTS, |point| point.whole(limits::POINT)));
    let position = body.optional("position", Point3::decode);
    let range = body.optional("range", |node| node.choice(&RANGES, |name| Some(name == ASSUMED)));
    let text = body.optional("text", |node| node.text(limits::TEXT_CHARS));
    let description = body.optional("description", |node| node.text(limits::TEXT_CHARS));
    let crop = body.optional("crop", crop);
    Some(Detection {
        class: class?,
        confidence: confidence?,
        box_px: box_px?,
        map_points: ascending(map_points?.unwrap_or_default()),
        position_in_session: position?,
        range_assumed: range?.unwrap_or_default(),
        text: non_blank(text?),
        description: non_blank(description?),
        crop: crop?,
    })
}

fn box_px(node: &Node<'_>) -> Option<[f64; 4]> {
    let corners @ [x0, y0, x1, y1] = node.numbers(limits::PIXEL)?;
    if x0 > x1 || y0 > y1 {
        let got = format!("the box's corners are swapped: [{x0}, {y0}, {x1}, {y1}]");
        return node.refuse(got, "[x0, y0, x1, y1] with x0 <= x1 and y0 <= y1");
    }
    Some(corners)
}

/// Returns a reader that read nothing sends blank text: that is no reading.
fn non_blank(text: Option<String>) -> Option<String> {
    text.filter(|text| !text.trim().is_empty())
}

fn crop(node: &Node<'_>) -> Option<Crop> {
    let bytes = node.bytes()?;
    if bytes.len() > limits::CROP_BYTES {
        return node.refuse(
            format!("the crop is {}", counted(bytes.len(), "byte")),
            format!("{} bytes", limits::CROP_BYTES),
        );
    }
    match Crop::media_type_of(&bytes) {
        Some(media_type) => Some(Crop { media_type, bytes }),
        None => node.refuse("the crop is neither a PNG nor a JPEG file", "PNG or JPEG"),
    }
}
