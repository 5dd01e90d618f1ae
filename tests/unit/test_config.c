/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_config.c - the machine file: what is accepted, and what the cycle gets
 */
#include "config_help.h"

/* -- What is taken ------------------------------------------------------- */

static void the_built_in_machine_is_the_documented_one(void **state)
{
	struct machine_config c;

	(void)state;
	config_defaults(&c);
	assert_string_equal(c.name, "edm");
	assert_int_equal(c.backend, BACKEND_SIM);
	assert_int_equal(c.strategy, INTERP_SIMULTANEOUS);
	assert_int_equal(c.axes.present, 0xff);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &c.axes.axis[i];
		bool rotary = interp_axis_is_rotary((enum interp_axis)i);
		double travel = rotary ? 1e6 : 200;

		assert_true(l->pulse_mm == 0.001);
		assert_true(l->travel_min_mm == -travel);
		assert_true(l->travel_max_mm == travel);
		assert_true(l->v_max_mm_s == (rotary ? 60 : 80));
		assert_true(l->a_max_mm_s2 == 1000);
		assert_true(l->j_max_mm_s3 == 20000);
		assert_true(c.start_mm[i] == 0);
	}
	assert_true(c.gap.servo_v == 25 && c.gap.short_v == 8);
	assert_true(c.sim.area_mm2 == 19.635);
	assert_string_equal(c.lcm_url, "udpm://239.255.76.67:7667?ttl=0");
	assert_string_equal(c.store_dir, "/var/lib/edmd");
	assert_int_equal(config_period_ns(&c), 1000000);
}

static void lcm_s_own_variable_gives_the_url_that_no_file_does(void **state)
{
	struct machine_config c;

	(void)state;
	setenv("LCM_DEFAULT_URL", "udpm://239.255.1.2:7700?ttl=0", 1);
	read_good("", &c);
	assert_string_equal(c.lcm_url, "udpm://239.255.1.2:7700?ttl=0");
	read_good("[lcm]\nurl = udpm://239.255.1.3:7700?ttl=0\n", &c);
	assert_string_equal(c.lcm_url, "udpm://239.255.1.3:7700?ttl=0");
	unsetenv("LCM_DEFAULT_URL");
}

static void every_default_passes_the_check_between_keys(void **state)
{
	struct machine_config c, d;

	(void)state;
	config_defaults(&d);
	read_good("", &c);
	assert_same(&c, &d);
}

static void a_key_changes_its_value_and_no_other(void **state)
{
	struct machine_config c, d;

	(void)state;
	config_defaults(&d);
	d.work_offset_mm[1][INTERP_C] = -12.5;
	d.axes.axis[INTERP_B].v_max_mm_s = 7;
	d.axes.present &= ~(UINT32_C(1) << INTERP_V);
	d.backend = BACKEND_NULL;
	strcpy(d.name, "sinker-2");
	read_good("[work.G55]\nc = -12.5\n[axis.B]\nv_max_mm_s = 7\n"
		  "[axis.V]\npresent = no\n"
		  "[machine]\nbackend = null\nname = sinker-2\n", &c);
	assert_same(&c, &d);
}

static void comments_blanks_and_line_ends_do_not_matter(void **state)
{
	struct machine_config c;

	(void)state;
	read_good("\xef\xbb\xbf; first\r\n# second\r\n\r\n"
		  "  [gap]  ; of a sinker\r\n"
		  "\tservo_v=20 # volts\r\n"
		  "   short_v : 9 ; volts\r\n[jump]\r\nheight_mm = 3", &c);
	assert_true(c.gap.servo_v == 20 && c.gap.short_v == 9);
	assert_true(c.jump.height_mm == 3);
}

static void the_longest_store_that_fits_is_taken_whole(void **state)
{
	struct machine_config c;
	struct interp_diag diag;
	char text[400] = "[jobs]\nstore = ";
	size_t n = strlen(text), most = sizeof(c.store_dir) - 1;

	(void)state;
	memset(text + n, 'x', most);
	read_good(text, &c);
	assert_string_equal(c.store_dir, text + n);

	text[n + most] = 'x';
	assert_int_equal(read_text(text, &c, &diag), -EINVAL);
	assert_non_null(strstr(diag.found, "is too long"));
}

/* -- Print and read ------------------------------------------------------ */

static void what_is_printed_reads_back_the_same(void **state)
{
	struct machine_config c, back;
	char *text;

	(void)state;
	config_defaults(&c);
	c.period_us = 1e3 / 3;
	c.strategy = INTERP_POINT_BY_POINT;
	c.axes.present = 0x81;
	c.axes.axis[INTERP_Y].pulse_mm = 0.1 + 0.2;
	c.start_mm[INTERP_Z] = -1e-17;
	c.work_offset_mm[5][INTERP_V] = 1.0 / 7;
	c.sim.seed = 9007199254740991.0;
	strcpy(c.store_dir, "/srv/my jobs");
	text = print_text(&c);
	read_good(text, &back);
	free(text);
	assert_same(&c, &back);
	assert_true(back.period_us == c.period_us);
	assert_true(back.start_mm[INTERP_Z] == c.start_mm[INTERP_Z]);
	assert_true(back.sim.seed == c.sim.seed);
}

static void every_key_reads_back_at_its_smallest_and_largest(void **state)
{
	struct machine_config c;
	struct interp_diag diag;
	char num[32], back[32];

	(void)state;
	config_defaults(&c);
	for (int i = 0; config_key(i); i++) {
		const struct config_key *k = config_key(i);
		const double ends[] = { k->min, k->max };

		if (k->kind != KEY_NUMBER && k->kind != KEY_WHOLE &&
		    k->kind != KEY_COUNT)
			continue;
		for (int e = 0; e < 2; e++) {
			config_number(ends[e], num, sizeof(num));
			assert_int_equal(
				config_key_parse(k, 0, num, &c, &diag), 0);
			assert_string_equal(
				config_key_format(k, 0, &c, back,
						  sizeof(back)), num);
		}
	}
}

static void the_document_names_every_key_once(void **state)
{
	char *text = NULL, cell[64];
	size_t n;
	FILE *f = open_memstream(&text, &n);

	(void)state;
	assert_non_null(f);
	config_document(f);
	assert_int_equal(fclose(f), 0);
	for (int i = 0; config_key(i); i++) {
		char *at = text;
		int rows = 0, same = 0;

		snprintf(cell, sizeof(cell), "\n| `%s` |", config_key(i)->name);
		while ((at = strstr(at, cell))) {
			rows++;
			at++;
		}
		for (int j = 0; config_key(j); j++)
			same += strcmp(config_key(j)->name,
				       config_key(i)->name) == 0;
		assert_int_equal(rows, same);
	}
	free(text);
}

/* -- What the cycle gets ------------------------------------------------- */

static void soft_limits_are_rounded_inward(void **state)
{
	struct machine_config c;
	struct cycle_config cycle;

	(void)state;
	read_good("[axis.X]\npulse_mm = 0.003\ntravel_min_mm = -1\n"
		  "travel_max_mm = 2\n", &c);
	config_cycle(&c, &cycle);
	assert_int_equal(cycle.travel_min[INTERP_X], -333);
	assert_int_equal(cycle.travel_max[INTERP_X], 666);
	assert_int_equal(cycle.travel_min[INTERP_Z], -200000);
	assert_int_equal(cycle.travel_max[INTERP_C], 1000000000);
}

static void the_cycle_gets_seconds_as_cycles_of_its_period(void **state)
{
	struct machine_config c;
	struct cycle_config cycle;

	(void)state;
	read_good("[machine]\nperiod_us = 250\noverrun_limit = 7\n"
		  "[jump]\nevery_s = 1.5\n[gap]\nfeed_gain_mm_s_v = 0.03\n",
		  &c);
	config_cycle(&c, &cycle);
	assert_int_equal(cycle.period_ns, 250000);
	assert_int_equal(cycle.jump.every.cycles, 6000);
	assert_int_equal(cycle.overrun_limit, 7);
	assert_int_equal(cycle.points_max, 4096);
	assert_true(cycle.gap.gain_mm_s_v == 0.03);
	assert_true(cycle.gap.retract_limit_mm == 3);
	assert_false(cycle.dry_run);
}

static void positioning_has_no_limit_but_that_of_its_axes(void **state)
{
	struct machine_config c;
	struct cycle_config cycle;

	(void)state;
	read_good("[axis.X]\na_max_mm_s2 = 300\nj_max_mm_s3 = 3000\n"
		  "[axis.Y]\na_max_mm_s2 = 400\nj_max_mm_s3 = 4000\n"
		  "[axis.U]\na_max_mm_s2 = 7000\npresent = no\n", &c);
	c.axes.present = 1u << INTERP_X | 1u << INTERP_Y;
	config_cycle(&c, &cycle);
	assert_true(cycle.travel_a_mm_s2 == 500);
	assert_true(cycle.travel_j_mm_s3 == 5000);
}

/* 0 in the file is what the machine has of its own. */
static void the_servo_takes_from_the_machine_what_is_not_given(void **state)
{
	struct machine_config c;
	struct cycle_config cycle;

	(void)state;
	read_good("[axis.Y]\na_max_mm_s2 = 300\n"
		  "[sim]\nopen_v = 120\noff_us = 33\n", &c);
	config_cycle(&c, &cycle);
	assert_true(cycle.gap.feed_a_mm_s2 == 0);
	assert_true(cycle.gap.ignition_v == 120);
	assert_true(cycle.gap.off_us == 33);
	c.backend = BACKEND_NULL;
	config_cycle(&c, &cycle);
	assert_true(cycle.gap.ignition_v == 0 && cycle.gap.off_us == 0);
	read_good(
		"[machine]\nbackend = null\n[gap]\nfeed_a_mm_s2 = 5\nignition_v = 90\noff_us = 7\n"
		"stuck_s = 2\nretract_to = motion\nprocess = wire\n"
		"source = lines\n[jump]\nevery_mm = 0.5\nadaptive = yes\n",
		&c);
	config_cycle(&c, &cycle);
	assert_true(cycle.gap.feed_a_mm_s2 == 5);
	assert_true(cycle.gap.ignition_v == 90 && cycle.gap.off_us == 7);
	assert_int_equal(cycle.gap.stuck.cycles, 2000);
	assert_int_equal(cycle.gap.retract_to, RETRACT_MOTION);
	assert_int_equal(cycle.gap.process, PROCESS_WIRE);
	assert_int_equal(cycle.gap.source, GAP_LINES);
	assert_true(cycle.jump.every_mm == 0.5 && cycle.jump.adaptive);
}

static void a_wire_machine_has_defaults_of_its_own(void **state)
{
	struct machine_config c;

	(void)state;
	read_good("[gap]\nprocess = wire\n[sim]\npeak_a = 30\n", &c);
	assert_int_equal(c.sim.process, PROCESS_WIRE);
	assert_true(c.sim.flush_per_s == 2 && c.sim.on_us == 2);
	assert_true(c.sim.peak_a == 30);
	/* A cavity in the simulation, whatever the control is told. */
	read_good("[sim]\nprocess = sink\n[gap]\nprocess = wire\n", &c);
	assert_int_equal(c.sim.process, PROCESS_SINK);
	assert_true(c.sim.on_us == 8);
	read_good("[sim]\nprocess = wire\n", &c);
	assert_int_equal(c.gap.process, PROCESS_SINK);
	assert_true(c.sim.on_us == 2);
}

/* Neighbours the other way; faster in all, or slower in all. */
static void what_is_believed_of_an_axis_is_off_by_the_model_error(void **state)
{
	struct machine_config c;

	(void)state;
	read_good("[contour]\nmodel_error = 0.25\n[axis.X]\n"
		  "loop_gain_1_s = 40\nloop_hz = 80\n"
		  "loop_delay_s = 0.004\n", &c);
	for (int odd = 0; odd < 2; odd++) {
		const double off = odd ? -0.25 : 0.25;
		const struct interp_axis_loop l =
			config_loop_true(&c, INTERP_X, odd);

		assert_true(l.gain_1_s == 40 * (1 + off));
		assert_true(l.velocity_hz == 80 * (1 + off));
		assert_true(l.delay_s == 0.004 * (1 - off));
	}
}

/* A changer's code, with or without m_stop. */
static void no_way_back_leads_over_m6(void **state)
{
	static const char *const texts[] = {
		"[plc]\nm_before = 6 60\n",
		"[plc]\nm_after = 6\nm_before = 60\nm_stop = 6\n"
	};

	(void)state;
	for (size_t i = 0; i < COUNT(texts); i++) {
		struct interp_mcode table[INTERP_NMCODES];
		struct machine_config c;
		struct interp_diag d;

		assert_int_equal(read_text(texts[i], &c, &d), 0);
		config_mcodes(&c, table);
		assert_int_equal(table[6].back, INTERP_MCODE_STOP);
		assert_int_equal(table[60].back, 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_wire_machine_has_defaults_of_its_own),
		cmocka_unit_test(the_built_in_machine_is_the_documented_one),
		cmocka_unit_test(
			lcm_s_own_variable_gives_the_url_that_no_file_does),
		cmocka_unit_test(every_default_passes_the_check_between_keys),
		cmocka_unit_test(a_key_changes_its_value_and_no_other),
		cmocka_unit_test(comments_blanks_and_line_ends_do_not_matter),
		cmocka_unit_test(the_longest_store_that_fits_is_taken_whole),
		cmocka_unit_test(what_is_printed_reads_back_the_same),
		cmocka_unit_test(every_key_reads_back_at_its_smallest_and_largest),
		cmocka_unit_test(the_document_names_every_key_once),
		cmocka_unit_test(soft_limits_are_rounded_inward),
		cmocka_unit_test(the_cycle_gets_seconds_as_cycles_of_its_period),
		cmocka_unit_test(positioning_has_no_limit_but_that_of_its_axes),
		cmocka_unit_test(the_servo_takes_from_the_machine_what_is_not_given),
		cmocka_unit_test(what_is_believed_of_an_axis_is_off_by_the_model_error),
		cmocka_unit_test(no_way_back_leads_over_m6),
	};

	return cmocka_run_group_tests_name("config", tests, make_file,
					   remove_file);
}
