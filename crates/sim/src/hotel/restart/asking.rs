//! The questions: each floor is a map, and a restart is asked against all of them, without a pose.

use super::world::{Restart, RestartWorld};
use crate::api::location::{LocateAnswerView, LocateBody, UnplacedKeyframeBody};
use crate::client::{Client, ClientError};
use crate::geometry::{Point3, Pose};
use crate::hotel::method::Method;
use crate::hotel::robot::client::{DriveError, Robot};
use crate::hotel::robot::message;
use crate::hotel::run::session;
use crate::hotel::sensing::camera::CAMERA;
use crate::hotel::sequence::{Step, by_odometry};

/// Returns the map of a floor.
pub fn map_of(seed: u64, storey: usize) -> String {
    format!("restart-{seed}-floor-{storey}")
}

/// Maps the floors, each by its robot, which closes its loops.
pub async fn map_floors(client: &Client, seed: u64, world: &RestartWorld) -> Result<(), DriveError> {
    for (storey, journey) in world.journeys.iter().enumerate() {
        let map = map_of(seed, storey);
        client.put_map(&map, &message::map(Method::Ours, "a floor of the simulated hotel")).await?;
        let mut robot = Robot::new(client, &map, Method::Ours, session(0));
        for step in &journey.steps {
            robot.ask(step).await?;
        }
        robot.finish().await?;
    }
    Ok(())
}

/// Asks where a restart is.
pub async fn ask(client: &Client, seed: u64, restart: &Restart) -> Result<LocateAnswerView, ClientError> {
    let body = LocateBody {
        keyframes: Some(keyframes(restart)),
        maps: Some(format!("restart-{seed}-floor-*").parse().into_iter().collect()),
        ..LocateBody::default()
    };
    client.locate(&body).await
}

/// Returns the keyframes with their poses in the frame of the first one's camera, by odometry.
fn keyframes(restart: &Restart) -> Vec<UnplacedKeyframeBody> {
    let poses = by_odometry(&restart.steps);
    restart.steps.iter().zip(&poses).map(|(step, pose)| keyframe(step, pose)).collect()
}

/// Returns what the camera sees: its depth camera knows where each feature is.
fn keyframe(step: &Step, first_from_camera: &Pose) -> UnplacedKeyframeBody {
    let every: Vec<(u64, Point3)> = (step.map_points.iter().zip(&step.features))
        .map(|(id, feature)| (*id, first_from_camera.transform(&feature.in_camera)))
        .collect();
    UnplacedKeyframeBody {
        pose: Some((*first_from_camera).into()),
        camera: Some(CAMERA.into()),
        features: Some(message::features(step)),
        map_points: Some(message::points(&every)),
        detections: Some(message::detections(step)),
        ..UnplacedKeyframeBody::default()
    }
}
