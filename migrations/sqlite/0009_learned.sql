-- What a map has learned of its building, kept beside its figures: each commit writes it with them, so that a reader of the
-- map loads nothing. JSON; null until the first write after this migration.
alter table maps add column learned text;

-- Pairs of keyframes of one view, by geometry, around which different signs hang. A row whose keyframes or anchors are gone,
-- or whose signs no longer differ, counts for nothing and gives way to the next pair that is found.
create table twins (
    map_key integer not null,
    -- The keyframe that was written last, and the one that it was taken for.
    keyframe integer not null,
    candidate integer not null,
    -- The signs that exclude each other.
    anchor integer not null,
    candidate_anchor integer not null,
    constraint twins_key primary key (map_key, keyframe, candidate, anchor, candidate_anchor),
    constraint twins_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;
