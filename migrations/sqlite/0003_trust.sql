-- Who may do what, who pays for models, and how much a map holds.

-- A key is never deleted, only revoked: a database that ever had keys does not open itself to everybody again.
create table keys (
    key integer not null,
    name text not null,
    -- SHA-256 of the secret, which is shown once and kept nowhere. It has 256 random bits: no salt and no slow hash is needed.
    hash blob not null,
    -- Bits: 1 read, 2 write, 4 query, 8 admin.
    actions integer not null,
    created_sec integer not null,
    expires_sec integer,
    expires_nanosec integer,
    revoked_sec integer,
    -- Requests a second.
    rate_per_s integer,
    -- What a day (UTC) of models may bring for the maps that this key made and the texts it asks about.
    model_daily_calls integer,
    model_daily_microusd integer,
    constraint keys_key primary key (key),
    constraint keys_hash unique (hash)
) strict;

create table key_maps (
    key integer not null,
    place integer not null,
    pattern text not null,
    constraint key_maps_key primary key (key, place),
    constraint key_maps_of foreign key (key) references keys (key) on delete cascade
) strict, without rowid;

-- One row, counted up with every key made or revoked: a server sees by it what another process did.
create table key_changes (
    only_row integer not null,
    change integer not null,
    constraint key_changes_key primary key (only_row)
) strict;

insert into key_changes (only_row, change) values (1, 0);

-- What a day of models brought for a key. What a call may cost is written before it is made.
create table key_usage (
    day integer not null,
    key integer not null,
    calls integer not null,
    cost_microusd integer not null,
    constraint key_usage_key primary key (day, key)
) strict, without rowid;

-- The key that made the map, which pays for its models; null if it was made without one.
alter table maps add column owner integer;

-- What a keyframe takes on disk, as far as its client's body says: words, points, features, crops.
alter table keyframes add column bytes integer not null default 0;

update keyframes set bytes =
    length(observes) + length(sent_points) + length(declared) + length(bow_words) + length(bow_weights)
    + coalesce((
        select length(descriptors) + length(keypoints) + length(map_points) from keyframe_features f
        where f.map_key = keyframes.map_key and f.keyframe = keyframes.keyframe
    ), 0)
    + coalesce((
        select sum(length(bytes)) from crops c
        where c.map_key = keyframes.map_key and c.keyframe = keyframes.keyframe
    ), 0);
