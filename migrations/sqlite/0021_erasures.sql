-- What leaves a map, its releases and the disk for good.
create table erasures (
    map_key integer not null,
    number integer not null,
    -- `removing`, `rewriting` or `done`.
    state text not null,
    -- What is to be erased, as JSON; null once it is removed, for it names what must not stay.
    asked text,
    keyframes integer not null,
    releases integer not null,
    begun_sec integer not null,
    begun_nanosec integer not null,
    ended_sec integer,
    ended_nanosec integer,
    constraint erasures_key primary key (map_key, number),
    constraint erasures_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- When a keyframe was stored, by the server's clock; what was stored before counts from now on.
alter table keyframes add column stored_sec integer not null default 0;
update keyframes set stored_sec = unixepoch();
