-- Anchors that a plan shows, known before any robot saw them. The row in anchors has their class and version.
create table prior_anchors (
    map_key integer not null,
    anchor integer not null,
    -- Chosen by the client.
    id text not null,
    -- The session that stands for the plan's frame.
    frame integer not null,
    description text not null,
    -- Three packed f64 in the plan's frame, in metres.
    position blob not null,
    -- Three packed f64: the unit vector out of the wall; null where the plan does not say.
    normal blob,
    source text,
    constraint prior_anchors_key primary key (map_key, anchor),
    constraint prior_anchors_id unique (map_key, id),
    constraint prior_anchors_anchor foreign key (map_key, anchor)
        references anchors (map_key, anchor) on delete cascade
) strict, without rowid;
