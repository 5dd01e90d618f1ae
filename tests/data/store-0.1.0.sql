-- SPDX-License-Identifier: Apache-2.0
-- A store as edmd-jobs 0.1.0 made it: version 2, the texts beside the jobs.
CREATE TABLE job( n INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE, name TEXT NOT NULL, sha256 TEXT NOT NULL, text BLOB NOT NULL, lines INTEGER NOT NULL, state TEXT NOT NULL DEFAULT 'queued', hold INTEGER NOT NULL, loaded INTEGER NOT NULL DEFAULT 0, submitted_us INTEGER NOT NULL, begun_us INTEGER NOT NULL DEFAULT 0, ended_us INTEGER NOT NULL DEFAULT 0, reason TEXT NOT NULL DEFAULT '', place_mm REAL, length_mm REAL, depth_mm REAL, job_s REAL, jumps INTEGER, retracts INTEGER, shorts INTEGER, tech_sha256 TEXT NOT NULL DEFAULT '');
CREATE TABLE change( n INTEGER NOT NULL, time_ns INTEGER NOT NULL, what TEXT NOT NULL, was, now, place_mm REAL, PRIMARY KEY(n, time_ns, what));
CREATE INDEX job_by_state ON job(state, loaded);
CREATE TABLE event( utime INTEGER NOT NULL, kind TEXT NOT NULL, job TEXT NOT NULL, outcome TEXT NOT NULL, place_mm REAL, text TEXT NOT NULL);
CREATE TABLE number( key TEXT PRIMARY KEY, value INTEGER NOT NULL);
CREATE TABLE key( public TEXT PRIMARY KEY, name TEXT NOT NULL UNIQUE, role TEXT NOT NULL, added_us INTEGER NOT NULL);
CREATE TABLE act( id INTEGER PRIMARY KEY, instance INTEGER NOT NULL, born INTEGER NOT NULL, verb TEXT NOT NULL, by TEXT NOT NULL, begun_us INTEGER NOT NULL, code INTEGER, reason TEXT);
INSERT INTO job(id, name, sha256, text, lines, state, hold, submitted_us, begun_us, ended_us, place_mm, length_mm, depth_mm, job_s, jumps, retracts, shorts) VALUES('old-done', 'done.ngc', '28d35cf9d22cffcd36d3e62c1ba10a8dbebd6e73dd3e63df5d9ed4e9ef16bb8b', 'G1 X1', 1, 'done', 0, 1700000000000000, 1700000001000000, 1700000100000000, 1, 1, 0, 99, 3, 2, 1);
INSERT INTO job(id, name, sha256, text, lines, state, hold, submitted_us) VALUES('old-queued', 'queued.ngc', 'f7257189eb281bad7ec8053145bc1151b93eb0be220b00abab0b0290ac039a41', CAST('G21 G90' || char(10) || 'G1 X1 F60' || char(10) || 'M30' || char(10) AS BLOB), 3, 'queued', 0, 1700000200000000);
INSERT INTO change VALUES(1, 5, 'condition', NULL, 'C120', 0.5);
INSERT INTO event VALUES(1700000100000000, 'ended', 'old-done', 'done', 1, 'job done.ngc done');
INSERT INTO number VALUES('waiting', 1);
PRAGMA user_version=2;
