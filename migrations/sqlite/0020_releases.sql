-- Releases: named versions of a map. The rows of each are those of a map of its own, to which nobody writes and whose id is
-- `map/release`, which no client can give. `maps.deleted` is 2 while rows are copied to a map that is not complete yet.
create table releases (
    map_key integer not null,
    name text not null,
    release_key integer not null,
    -- The map's version that it holds. That of its own map is higher once something was erased from it.
    map_version integer not null,
    -- How often something was erased from it for good.
    erasures integer not null default 0,
    description text not null,
    published_sec integer not null,
    published_nanosec integer not null,
    -- SHA-256 of the request, to tell a retry from another release of the same name.
    digest blob not null,
    constraint releases_key primary key (map_key, name),
    constraint releases_rows unique (release_key),
    constraint releases_map foreign key (map_key) references maps (map_key) on delete cascade,
    constraint releases_held_by foreign key (release_key) references maps (map_key) on delete cascade
) strict, without rowid;

-- Who asked a release. Here `map_key` is that of the map that holds its rows.
create table release_uses (
    map_key integer not null,
    session text not null,
    queries integer not null,
    last_sec integer not null,
    last_nanosec integer not null,
    constraint release_uses_key primary key (map_key, session),
    constraint release_uses_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;
