-- Verdicts that are asked for again when a model or its prompts change: which model stands behind a verdict,
-- which verdict stood before, and the jobs that ask.

-- Why, in one sentence by the model; empty in rows that are older than this column.
alter table model_verdicts add column reason text not null default '';
-- The hash of the models and prompts behind the row; empty where it was not kept.
alter table model_verdicts add column fingerprint text not null default '';
alter table model_readings add column fingerprint text not null default '';

-- Verdicts as they stood until this version of the map replaced them. They explain the answers of earlier versions.
create table replaced_verdicts (
    map_key integer not null,
    map_version integer not null,
    operation text not null,
    class text not null,
    a text not null,
    b text not null,
    level integer,
    text text,
    source text not null,
    reason text not null,
    fingerprint text not null,
    constraint replaced_verdicts_key primary key (map_key, map_version, operation, class, a, b),
    constraint replaced_verdicts_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- The same of readings, each with its dialogue.
create table replaced_readings (
    map_key integer not null,
    map_version integer not null,
    keyframe integer not null,
    detection integer not null,
    text text not null,
    source text not null,
    described integer not null,
    degraded integer not null,
    fingerprint text not null,
    constraint replaced_readings_key primary key (map_key, map_version, keyframe, detection),
    constraint replaced_readings_detection foreign key (map_key, keyframe, detection)
        references detections (map_key, keyframe, detection) on delete cascade
) strict, without rowid;

create index replaced_readings_by_detection on replaced_readings (map_key, keyframe, detection);

create table replaced_transcripts (
    map_key integer not null,
    map_version integer not null,
    keyframe integer not null,
    detection integer not null,
    step integer not null,
    speaker text not null,
    question text not null,
    answer text not null,
    constraint replaced_transcripts_key primary key (map_key, map_version, keyframe, detection, step),
    constraint replaced_transcripts_reading foreign key (map_key, map_version, keyframe, detection)
        references replaced_readings (map_key, map_version, keyframe, detection) on delete cascade
) strict, without rowid;

-- The jobs that ask again, each with the question that it has come to.
create table judgements (
    map_key integer not null,
    id text not null,
    -- Jobs of a map are counted, so that the oldest can go.
    number integer not null,
    -- `all`, `texts` or `crops`.
    asks text not null,
    -- `running`, `done` or `stopped`.
    state text not null,
    -- The map's version when it began.
    since_version integer not null,
    -- As foreseen when it began.
    questions integer not null,
    calls_max integer not null,
    cost_max_microusd integer not null,
    -- What has become of the questions so far.
    changed integer not null,
    unchanged integer not null,
    gone integer not null,
    failed integer not null,
    -- The question that was settled last: of a crop its keyframe and detection, of texts what was asked about which.
    -- Crops come first. All null before the first question is settled; of each kind only its own columns are set.
    at_operation text,
    at_keyframe integer,
    at_detection integer,
    at_class text,
    at_a text,
    at_b text,
    constraint judgements_key primary key (map_key, id),
    constraint judgements_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;
