//! The three functions of §IV-A.2 asked by hand, what models cost, and the dialogues that described an anchor.

use super::anchors::object_of;
use crate::domain::ids::{KeyframeSeq, MapId};
use crate::domain::judged::{CropReading, Transcript};
use crate::domain::key::KeySeq;
use crate::domain::prior::AnchorKey;
use crate::domain::report::UsageReport;
use crate::engine::keys::access::Access;
use crate::engine::{Result, Service};
use crate::llm::judge::Judge;
use crate::store::DayLimit;

/// Maximum dialogues that an anchor shows, the newest first.
const TRANSCRIPTS_SHOWN: usize = 32;

impl Service {
    /// Returns the three functions, at the expense of who asks.
    pub fn judge(&self, asks: &Access) -> Judge {
        let Some(models) = &self.models else { return Judge::default() };
        models.judge.paid_by(self.payer(asks.key()))
    }

    /// Who pays, with the limits of the key.
    pub(in crate::engine) fn payer(&self, key: Option<KeySeq>) -> Option<DayLimit> {
        let key = key?;
        let held = self.keys.held(key)?;
        let properties = &held.key.properties;
        Some(DayLimit {
            payer: key.0,
            calls: properties.model_daily_calls.map(i64::from),
            microusd: properties.model_daily_microusd.map(|microusd| microusd as i64),
        })
    }

    /// Returns what models were asked and what it cost; `None` without any.
    pub fn usage(&self) -> Option<UsageReport> {
        let models = self.models.as_ref()?;
        let (today, limits) = models.budget().today();
        Some(UsageReport {
            lines: models.budget().usage(),
            calls_today: today.calls as u64,
            microusd_today: today.cost_microusd as u64,
            daily_calls: limits.calls.map(|calls| calls as u64),
            daily_microusd: limits.microusd.map(|microusd| microusd as u64),
            away: models.is_away(),
        })
    }

    /// Returns the dialogues that described an anchor, the newest first.
    pub async fn transcripts(&self, map: &MapId, key: AnchorKey) -> Result<(u64, Vec<Transcript>)> {
        let live = self.live(map).await?;
        let (version, readings) = self
            .read(&live, move |state| {
                let index = &state.index;
                let members =
                    object_of(index, &key)?.members.iter().filter_map(|member| index.anchor(*member));
                let mut readings: Vec<(KeyframeSeq, u16, String, CropReading)> = members
                    .flat_map(|anchor| anchor.observations.values())
                    .filter_map(|seen| {
                        let keyframe = index.keyframe(seen.keyframe)?.id.to_string();
                        Some((seen.keyframe, seen.detection, keyframe, seen.crop_reading.clone()?))
                    })
                    .collect();
                readings.sort_by_key(|(keyframe, detection, ..)| std::cmp::Reverse((*keyframe, *detection)));
                readings.truncate(TRANSCRIPTS_SHOWN);
                Ok(readings)
            })
            .await?;
        let mut transcripts = Vec::new();
        for (seq, detection, keyframe, reading) in readings {
            let steps = self.store.transcript(live.key, seq, detection).await?;
            transcripts.push(Transcript { keyframe, detection, reading, steps });
        }
        Ok((version, transcripts))
    }
}
