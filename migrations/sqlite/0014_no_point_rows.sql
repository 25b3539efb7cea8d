-- All of them are in blocks by now: the program moves them between the two migrations.
drop table map_points;
