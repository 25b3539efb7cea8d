-- The greatest number that the next event of a deleted map would have had: events of new maps are numbered from above it.
-- SQLite's `user_version` held it until now; another engine has none.
create table event_numbers (
    only_row integer not null,
    last integer not null,
    constraint event_numbers_key primary key (only_row)
) strict;

insert into event_numbers (only_row, last) select 1, user_version from pragma_user_version;
