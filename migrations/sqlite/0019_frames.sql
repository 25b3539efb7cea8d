-- One frame for all sessions of a map.

-- candidate_from_query of the query that found the loop, as eight float64: scale, translation, quaternion; null if it is not known.
alter table loops add column candidate_from_query blob;

-- Where the sessions lie to each other, computed once by the server that owns the map, and read by all.
create table fleet_frames (
    map_key integer not null,
    -- The map's version that it was computed at.
    version integer not null,
    body text not null,
    constraint fleet_frames_key primary key (map_key),
    constraint fleet_frames_map foreign key (map_key) references maps (map_key) on delete cascade
) strict, without rowid;
