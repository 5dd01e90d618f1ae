/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_seal.c - messages/sign: envelopes, key files, plain text
 */
#include "keyfile.h"
#include "plain.h"
#include "seal.h"

#include "edm_signed_t.h"

#include <errno.h>
#include <setjmp.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[] = "/tmp/edm-seal-XXXXXX";

static struct keyfile key_of(const char *seed_hex)
{
	struct keyfile k = { .machine = "edm", .name = "host",
			     .role = "service" };
	uint8_t seed[SEAL_KEY_BYTES];

	assert_true(keyfile_unhex(seed, seed_hex));
	crypto_sign_seed_keypair(k.public, k.secret, seed);
	memcpy(k.machine_key, k.public, sizeof(k.public));
	return k;
}

/* The vectors of messages/README.md. */
#define SEED	"000102030405060708090a0b0c0d0e0f" \
		"101112131415161718191a1b1c1d1e1f"
#define CHANNEL	"EDM.edm.COMMAND"

static void the_readme_s_vector_is_what_is_made(void **state)
{
	const struct keyfile k = key_of(SEED);
	const struct seal s = { .key = k.public, .boot = 1, .count = 2,
				.data = "abc", .size = 3 };
	uint8_t packet[SEAL_BYTES + 3];
	char hex[2 * sizeof(packet) + 1], path[256], line[512] = "";
	FILE *f;

	(void)state;
	assert_int_equal(seal_make(packet, &s, CHANNEL, k.secret),
			 sizeof(packet));
	sodium_bin2hex(hex, sizeof(hex), packet, sizeof(packet));
	snprintf(path, sizeof(path), "messages/vectors.txt");
	f = fopen(path, "re");
	assert_non_null(f);
	while (fgets(line, sizeof(line), f) && strncmp(line, "packet ", 7) != 0)
		;
	fclose(f);
	line[strcspn(line, "\n")] = '\0';
	assert_string_equal(line + 7, hex);
}

static void the_envelope_is_the_type_that_lcm_knows(void **state)
{
	const struct keyfile k = key_of(SEED);
	const struct seal s = { .key = k.public, .boot = -5, .count = 77,
				.data = "abcd", .size = 4 };
	uint8_t packet[SEAL_BYTES + 4];
	edm_signed_t m;

	(void)state;
	seal_make(packet, &s, CHANNEL, k.secret);
	assert_true(edm_signed_t_decode(packet, 0, sizeof(packet), &m) > 0);
	assert_memory_equal(m.key, k.public, sizeof(m.key));
	assert_int_equal(m.boot, -5);
	assert_int_equal(m.count, 77);
	assert_int_equal(m.size, 4);
	assert_memory_equal(m.data, "abcd", 4);
	edm_signed_t_decode_cleanup(&m);
}

static void every_flipped_bit_is_noticed(void **state)
{
	const struct keyfile k = key_of(SEED);
	const struct seal s = { .key = k.public, .boot = 1, .count = 2,
				.data = "abc", .size = 3 };
	uint8_t packet[SEAL_BYTES + 3];
	struct seal got;

	(void)state;
	seal_make(packet, &s, CHANNEL, k.secret);
	assert_true(seal_read(&got, packet, sizeof(packet)));
	assert_true(seal_holds(&got, CHANNEL));
	assert_false(seal_holds(&got, "EDM.edm.JOB"));
	assert_false(seal_holds(&got, "EDM.edn.COMMAND"));
	for (size_t i = 0; i < 8 * sizeof(packet); i++) {
		packet[i / 8] ^= (uint8_t)(1u << i % 8);
		assert_false(seal_read(&got, packet, sizeof(packet)) &&
			     seal_holds(&got, CHANNEL));
		packet[i / 8] ^= (uint8_t)(1u << i % 8);
	}
	for (size_t n = 0; n < sizeof(packet); n++)
		assert_false(seal_read(&got, packet, n));
}

static void path_in(char to[128], const char *name)
{
	snprintf(to, 128, "%s/%s", folder, name);
}

static void write_text(const char *path, const char *text, mode_t mode)
{
	FILE *f = fopen(path, "we");

	assert_non_null(f);
	fputs(text, f);
	fclose(f);
	assert_int_equal(chmod(path, mode), 0);
}

static void a_key_file_is_read_as_written(void **state)
{
	struct keyfile k = key_of(SEED), got;
	char path[128], said[KEYFILE_SAID_MAX];
	struct stat st;

	(void)state;
	path_in(path, "good.key");
	assert_int_equal(keyfile_write(&k, path, 0640), 0);
	assert_int_equal(stat(path, &st), 0);
	assert_int_equal(st.st_mode & 07777, 0640);
	assert_int_equal(keyfile_read(&got, path, said), 0);
	assert_memory_equal(&got, &k, sizeof(k));
}

static void a_bad_key_file_says_what_mends_it(void **state)
{
	struct keyfile k = key_of(SEED), got;
	char path[128], said[KEYFILE_SAID_MAX];

	(void)state;
	path_in(path, "none.key");
	assert_int_equal(keyfile_read(&got, path, said), -ENOENT);
	assert_non_null(strstr(said, "edmctl keys add"));
	path_in(path, "wide.key");
	assert_int_equal(keyfile_write(&k, path, 0644), 0);
	assert_int_equal(keyfile_read(&got, path, said), -EPERM);
	assert_non_null(strstr(said, "make a new one"));
	assert_int_equal(chmod(path, 0660), 0);
	assert_int_equal(keyfile_read(&got, path, said), -EPERM);
	assert_non_null(strstr(said, "chmod g-w"));
	path_in(path, "cut.key");
	write_text(path, "edmd-key 1\nmachine edm\n", 0600);
	assert_int_equal(keyfile_read(&got, path, said), -EINVAL);
	assert_non_null(strstr(said, "no line 'name'"));
	write_text(path, "edmd-key 1\nmachine edm\nhello there\n", 0600);
	assert_int_equal(keyfile_read(&got, path, said), -EINVAL);
	assert_non_null(strstr(said, "cut.key:3:"));
	write_text(path, "\x7f" "ELF\x01\xff", 0600);
	assert_int_equal(keyfile_read(&got, path, said), -EINVAL);
	k.public[0] ^= 1;
	assert_int_equal(keyfile_write(&k, path, 0600), 0);
	assert_int_equal(keyfile_read(&got, path, said), -EINVAL);
	assert_non_null(strstr(said, "not that of its secret"));
}

static void what_moves_a_terminal_is_not_plain(void **state)
{
	static const char *const bad[] = {
		"\x1b[2J", "\x9b" "2J", "\xc2\x9b" "2J", "a\xe2\x80\xae" "b",
		"\xe2\x81\xa6", "\xc2\x85", "\x7f", "\n", "\xef\xbb\xbf",
		"\xe1\xa0\x8e", "\xe3\x85\xa4", "\xcd\x8f", "\xef\xbe\xa0",
		"\xc0\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x80",
	};
	char text[64];

	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		assert_false(plain_is(bad[i]));
		plain_copy(text, sizeof(text), bad[i]);
		assert_true(plain_is(text));
	}
	assert_true(plain_is("Gr\xc3\xb6\xc3\x9f" "e \xe9\x80\x9a"));
	plain_copy(text, 5, "ab\xc3\xb6\xc3\xb6");
	assert_string_equal(text, "ab\xc3\xb6");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_readme_s_vector_is_what_is_made),
		cmocka_unit_test(the_envelope_is_the_type_that_lcm_knows),
		cmocka_unit_test(every_flipped_bit_is_noticed),
		cmocka_unit_test(a_key_file_is_read_as_written),
		cmocka_unit_test(a_bad_key_file_says_what_mends_it),
		cmocka_unit_test(what_moves_a_terminal_is_not_plain),
	};
	char command[64];
	int rc;

	if (sodium_init() < 0 || !mkdtemp(folder))
		return 1;
	rc = cmocka_run_group_tests_name("seal", tests, NULL, NULL);
	snprintf(command, sizeof(command), "rm -r %s", folder);
	return system(command) ? 1 : rc;
}
