/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compiling.h - a machine file as the options with which a job is compiled
 *
 * Threads: any, each with a struct of its own.
 */
#ifndef CONFIG_COMPILING_H
#define CONFIG_COMPILING_H

#include "config.h"

#include "interp/compile.h"

/* The result of config_tech_load(). */
struct config_tech {
	struct interp_tech_table *table;	/* NULL: there is none */
	char path[512];
	char *text;			/* as read; NULL without a table */
	size_t bytes;
	struct interp_diag diag;	/* filled with -EINVAL */
};

/**
 * config_tech_load() - read a technology table, and check that it may go over
 * the machine's values.
 *
 * @path: NULL is [tech] table, beside the machine file; an .enc file is read
 * as one, any other as .tech.
 * Return: 0; -errno of the file; -EINVAL with ret->diag filled; -ENOMEM.
 * ret->path says which file, and ret is to be handed to config_tech_free() in
 * any case.  Any thread.
 */
int config_tech_load(struct config_tech *ret, const struct machine_config *c,
		     const char *path);
void config_tech_free(struct config_tech *t);

/** config_tech_why() - what went wrong, as one line into @buf. */
void config_tech_why(const struct config_tech *t, int err, char *buf,
		     size_t size);

/* The result of config_dialect_load(). */
struct config_dialect {
	const struct interp_dialect *use;
	struct interp_dialect *own;	/* read from a file; NULL: built in */
	char *text;			/* of that file; NULL: built in */
	size_t bytes;
	char path[512];			/* of that file, or the name */
	struct interp_diag diag;	/* filled with -EINVAL */
};

/** config_dialect_is_file() - is @name a file, not the name of a dialect? */
bool config_dialect_is_file(const char *name);

/**
 * config_dialect_load() - find the dialect in which a job is written.
 *
 * @asked: a name, or a file that ends in .ini.  NULL: the end of @job's name
 * decides, or else [nc] dialect.  A name that does not exist is refused at line
 * 0.
 *
 * Return: 0; -errno of the file; -EINVAL with ret->diag filled; -ENOMEM.  @ret
 * must be given to config_dialect_free() in any case.  Any thread.
 */
int config_dialect_load(struct config_dialect *ret,
			const struct machine_config *c, const char *asked,
			const char *job);
void config_dialect_free(struct config_dialect *d);

/** config_dialect_why() - what went wrong, as one line into @buf. */
void config_dialect_why(const struct config_dialect *d, int err, char *buf,
			size_t size);

/** config_tech_base() - the machine's own values of the fields. */
void config_tech_base(const struct machine_config *c, struct interp_tech *ret);

/**
 * config_kinematics() - the machine's joints.
 * Return: 0; -ENOENT if [kinematics] names none; -EINVAL with @diag filled.
 */
int config_kinematics(const struct machine_config *c,
		      struct interp_kinematics *ret, struct interp_diag *diag);

/**
 * config_check_kinematics() - is [kinematics] a chain of this machine's axes?
 *
 * Only programs that compile need this; edmd does not ask.
 *
 * Return: 0, or -EINVAL with @diag filled.
 */
int config_check_kinematics(const struct machine_config *c,
			    struct interp_diag *diag);

/* The options point into the other members, into the machine file and into the
 * table.  So the struct must stay where it was filled, and must not outlive
 * them. */
struct config_compiling {
	struct interp_build_options build;
	struct interp_compile_options text;
	struct interp_mcode mcodes[INTERP_NMCODES];
	struct interp_tech tech;
	struct interp_wire wire;
	struct interp_kinematics kinematics;
	struct interp_delivery delivery;
};

/**
 * config_compiling() - fill @ret.
 *
 * The path begins at start_mm of the axes.  A caller that knows better where
 * the machine stands sets build.start_mm afterwards.
 */
void config_compiling(const struct machine_config *c,
		      const struct config_tech *tech,
		      struct config_compiling *ret);

/**
 * config_compiling_set() - what is set for this job goes before what is set in
 * the machine file: interp/setting_text.h.
 *
 * Return: 0, or -EINVAL with @diag filled.
 */
int config_compiling_set(struct config_compiling *of, const char *setting,
			 struct interp_diag *diag);

#endif /* CONFIG_COMPILING_H */
