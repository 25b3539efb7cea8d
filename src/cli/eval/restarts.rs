//! Restarts: a robot wakes up on one of three floors that look alike, and asks where it is.

use super::arguments::HotelArgs;
use crate::cli::failure::Failure;
use crate::cli::output::write_out;
use crate::client::Client;
use crate::hotel::building::texture::Patterns;
use crate::hotel::restart::asking::{ask, map_floors, map_of};
use crate::hotel::restart::score::RestartScore;
use crate::hotel::restart::world::RestartWorld;

/// Runs the restarts of some worlds, prints the table, and writes it as JSON.
pub(super) async fn run(args: &HotelArgs, client: &Client, count: u64) -> Result<(), Failure> {
    let set = args.world_set()?;
    let mut all = RestartScore::default();
    for seed in set.seeds().take(count as usize) {
        let keyframes = args.restart_keyframes;
        let make = move || RestartWorld::new(seed, keyframes, &Patterns::new());
        let world = tokio::task::spawn_blocking(make).await?;
        map_floors(client, seed, &world).await?;
        let mut score = RestartScore::default();
        for restart in &world.restarts {
            let answer = ask(client, seed, restart).await?;
            for score in [&mut score, &mut all] {
                score.add(seed, &world, restart, &answer);
            }
        }
        for storey in 0..world.journeys.len() {
            client.delete_map(&map_of(seed, storey)).await?;
        }
        write_out(&format!("world {seed}\n{}\n", score.table()))?;
    }
    std::fs::create_dir_all(&args.output)?;
    std::fs::write(args.output.join("restarts.json"), serde_json::to_vec_pretty(&all)?)?;
    Ok(write_out(&format!("{count} {set} of three floors alike\n{}", all.table()))?)
}
