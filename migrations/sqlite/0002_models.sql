-- What language and vision models said. Their verdicts are facts: a map's index is built from them,
-- so that a loop query asks nobody. What was paid for is kept as well, so that nothing is paid twice.

-- What a model, or a reader of characters, made of a detection's crop. Empty text: it made nothing of it.
create table model_readings (
    map_key integer not null,
    keyframe integer not null,
    detection integer not null,
    text text not null,
    -- `model:<name>`, or the reader's name.
    source text not null,
    -- Did a model describe it, rather than a reader of characters?
    described integer not null,
    -- Did a reader stand in because the model was away? It is read again then.
    degraded integer not null,
    constraint model_readings_key primary key (map_key, keyframe, detection),
    constraint model_readings_detection foreign key (map_key, keyframe, detection)
        references detections (map_key, keyframe, detection) on delete cascade
) strict;

-- The dialogue that led to a reading, step by step.
create table transcripts (
    map_key integer not null,
    keyframe integer not null,
    detection integer not null,
    step integer not null,
    -- Who answered, what was asked and what was answered, as sent.
    speaker text not null,
    question text not null,
    answer text not null,
    constraint transcripts_key primary key (map_key, keyframe, detection, step),
    constraint transcripts_reading foreign key (map_key, keyframe, detection)
        references model_readings (map_key, keyframe, detection) on delete cascade
) strict, without rowid;

-- SimilarityLevel, InformationLevel and MergeText of texts of one class, in normal form.
-- Of a pair the smaller text is `a`; of a single text `b` is empty.
create table model_verdicts (
    map_key integer not null,
    operation text not null,
    class text not null,
    a text not null,
    b text not null,
    -- 1 to 5; null for a merged text.
    level integer,
    -- The merged text; null for a level.
    text text,
    source text not null,
    constraint model_verdicts_key primary key (map_key, operation, class, a, b),
    constraint model_verdicts_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- The maps whose questions wait because the model is away: a verdict about them says so.
create table models_away (
    map_key integer not null,
    constraint models_away_key primary key (map_key),
    constraint models_away_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Every answer that was paid for, by the hash of all that it depends on.
create table model_answers (
    kept integer not null,
    key blob not null,
    operation text not null,
    model text not null,
    answer text not null,
    constraint model_answers_key primary key (kept),
    constraint model_answers_question unique (key)
) strict;

-- Calls and what they cost, by day since 1970 (UTC). What a call may cost is written before it is made.
create table model_usage (
    day integer not null,
    operation text not null,
    model text not null,
    calls integer not null,
    input_tokens integer not null,
    output_tokens integer not null,
    cost_microusd integer not null,
    cache_hits integer not null,
    constraint model_usage_key primary key (day, operation, model)
) strict, without rowid;
