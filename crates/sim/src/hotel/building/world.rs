//! World: a floor with its furnishing and its signs.

use std::collections::BTreeSet;

use super::floor_plan::{FloorPlan, Layout, Spot};
use super::furnishing::{Model, WorldPoint};
use super::signs::{Decorator, POINTS_PER_DIGIT_POINT, Sign, SignKind, SignPlan};
use super::texture::{Patterns, copy};
use crate::hotel::rng::SeededRng;

/// The parameters of a world.
#[derive(Clone, Debug)]
pub struct WorldPlan {
    /// The floor's dimensions.
    pub layout: Layout,
    /// The first digits of the floor's door numbers.
    pub floor: u32,
    /// The arrangement of its signs.
    pub signs: SignPlan,
    /// Seed of its furnishing.
    pub seed: u64,
}

/// A furnished floor with signs.
#[derive(Clone, Debug)]
pub struct World {
    /// The floor plan.
    pub plan: FloorPlan,
    /// The points that a camera can recognise.
    pub points: Vec<WorldPoint>,
    /// The signs.
    pub signs: Vec<Sign>,
    /// The rooms' numbers, in the order of their doors along the corridor.
    pub numbers: Vec<String>,
    /// The replaced numbers among them.
    pub renumbered: BTreeSet<String>,
}

impl World {
    /// Builds a world.
    pub fn new(of: &WorldPlan, patterns: &Patterns) -> Self {
        Self::storey(of, 0, patterns)
    }

    /// Builds the floor `storey` levels above: other copies of the same models, the same prints at the same places,
    /// and other numbers.
    pub fn storey(of: &WorldPlan, storey: usize, patterns: &Patterns) -> Self {
        let plan = FloorPlan::new(of.layout);
        let mut rng = SeededRng::new(of.seed, "furnishing");
        let model = Model::new(&plan, patterns, &mut rng);
        let mut of_storey = SeededRng::new(of.seed ^ ((storey as u64) << 32), "storey");
        if storey > 0 {
            rng = of_storey.clone();
        }
        let mut points = Vec::new();
        for room in &plan.rooms {
            points.extend(model.furnish_room(&room.door, &plan, patterns, &mut rng));
        }
        for bay in &plan.bays {
            points.extend(model.furnish_stretch(bay, &plan, patterns, &mut rng));
        }
        for corner_m in plan.corners_m() {
            let ([x, y], heading) = plan.centreline(corner_m - 1e-6);
            let spot = Spot { origin: [x, y], facing: [heading.cos(), heading.sin()] };
            points.extend(model.furnish_corner(&spot, &plan, &mut rng));
        }
        let numbers: Vec<String> =
            (1..=plan.rooms.len()).map(|n| format!("{}{n:02}", of.floor + storey as u32)).collect();
        let mut rng = SeededRng::new(of.seed, "signs");
        let mut decorator = Decorator { plan: &plan, patterns, points: &mut points };
        let signs = decorator.hang(&numbers, of.signs, &mut rng);
        for sign in signs.iter().filter(|_| storey > 0) {
            let is_plate = sign.kind == SignKind::DoorPlate;
            for (number, point) in points[sign.points.clone()].iter_mut().enumerate() {
                let is_digit = is_plate && number % POINTS_PER_DIGIT_POINT == 0;
                let look = if is_digit { patterns.model(&mut of_storey) } else { point.descriptor };
                point.descriptor = copy(look, &mut of_storey);
            }
        }
        Self { plan, points, signs, numbers, renumbered: BTreeSet::new() }
    }

    /// Replaces the plates of rooms by numbers new to the floor.
    pub fn renumber(&mut self, rooms: &[usize], patterns: &Patterns, rng: &mut SeededRng) {
        let floor = self.numbers[0][..self.numbers[0].len() - 2].to_owned();
        for room in rooms {
            let number = format!("{floor}{:02}", self.plan.rooms.len() + self.renumbered.len() + 1);
            let old = std::mem::replace(&mut self.numbers[*room], number.clone());
            let is_its = |sign: &&mut Sign| sign.kind == SignKind::DoorPlate && sign.text == old;
            if let Some(plate) = self.signs.iter_mut().find(is_its) {
                plate.text.clone_from(&number);
                for point in plate.points.clone().step_by(POINTS_PER_DIGIT_POINT) {
                    self.points[point].descriptor = patterns.model(rng);
                }
            }
            self.renumbered.insert(number);
        }
    }
}
