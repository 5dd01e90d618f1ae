# SPDX-License-Identifier: Apache-2.0
#
#   make            build everything into build/
#   make demo       set up, build, run the main job on the simulated machine
#   make demo-plan  plan a way into a closed channel, prove it, cut along it
#   make check      set up, build, all tests; ends with the runner's own lines
#   make quick      of these, most of what goes wrong, in 90 s
#   make quick FOLDER=libinterp/core  the unit tests of that folder alone
#   make compile_commands.json  how each file is compiled, for editors and clangd
#   make check-strict  CAN against strict drives, in the virtual machine; long
#   make check-vm   all that runs on a PREEMPT_RT kernel in a virtual machine; the
#                   shorter half of it is in check
#   make bench-plan edm-plan on meshes of 10^3 to 10^6 triangles, some minutes
#   make hall       10, 30 and 100 machines over DDS, some 20 minutes
#   make bench      speed, as medians side by side
#   make count      instructions of what is done most, into docs/performance.md
#   make calls      system calls of edmd's threads, into docs/performance.md
#   make experiments  count the pulse rules and the ways along curves, time the
#                   jumps, try the contour compensations, compare servo
#                   values, into docs/experiments-*.md
#   make wire-random  ten thousand contours of a wire against another geometry
#   make speed-oracle  does each axis keep its limits along 480 random programs
#   make shipped    each shipped machine file and its jobs, for 100 seeds
#   make walkable   random programs of every dialect are walked, there and back
#   make invariants what holds in every cycle, over ten million random ones
#   make trace      when each period of build/edmd begins and ends, for perf
#   make callgraph  draw which file of the cycle calls which
#   make modbus-person  random jobs beside a generator on Modbus and a person
#   make faults     the table of faults in docs/, from the one in the code
#   make plc-files  EDS, DBC and the page of signals, from the one in the code
#   make pictures   draw what docs/ shows, into docs/pictures/, and the run that
#                   the README prints
#   make fuzz       the readers of jobs, and what edmd is given, under libFuzzer, a
#                   bounded time each
#   make panel      the operator's page, into build/panel
#   make lint       what the cycle may call, headers alone, who may include whom
#   make deb        Debian packages, into build/deb
#   make install    DESTDIR and PREFIX are honoured
#
#   V=1             show the commands
#   SAN=1           address and undefined sanitizers, into build-san/
#   TSAN=1          thread sanitizer, into build-tsan/
#   CC=clang        as usual
#   LTO=0           files are optimised one by one: edmd and edmsim link quicker

V	?= 0
Q	:= $(if $(filter 1,$(V)),,@)
say	= $(if $(filter 1,$(V)),,@printf '  %-7s %s\n' '$1' '$2')

PREFIX	?= /usr/local
# For the shell, which would take a name with blanks for two.
INTO	= '$(DESTDIR)'
BELOW	= '$(DESTDIR)$(PREFIX)'
BINDIR	= $(BELOW)/bin
UNITDIR	= $(INTO)/usr/lib/systemd/system
VERSION	:= $(shell sed -n 's/^\#\# \([0-9][0-9.]*\).*/\1/p' CHANGELOG.md | head -n 1)

# How many tests run side by side.
SIDE	?= $(shell n=$$(nproc); echo $$((n > 4 ? 4 : n)))

SAN	?= 0
TSAN	?= 0
B	:= build$(if $(filter 1,$(SAN)),-san)$(if $(filter 1,$(TSAN)),-tsan)
SANFLAGS = $(if $(filter 1,$(SAN)),-fsanitize=address$(,)undefined -fno-sanitize-recover=all -fno-omit-frame-pointer) \
	   $(if $(filter 1,$(TSAN)),-fsanitize=thread)
,	:= ,

# What runs under a sanitizer, and the tests themselves, are compiled and linked in
# half the time that way; a report still has its lines.
FAST	= -O1 -g1
OPT	?= $(if $(filter 1,$(SAN) $(TSAN)),$(FAST),-O2)
WARN	= -Wall -Wextra -Wconversion -Wshadow -Wpedantic $(if $(WERROR),-Werror)
CFLAGS	= -std=c11 -D_GNU_SOURCE -g $(OPT) $(WARN) -ffunction-sections \
	  -DEDM_VERSION='"$(VERSION)"' -DEDM_DIALECTS='"$(DIALECTS)"' $(SANFLAGS)
# A shim round a library of C++, whose own headers are not ours to mend.
CXXFLAGS = -std=c++17 -g $(OPT) -Wall -Wextra -Wshadow $(if $(WERROR),-Werror) \
	   -isystem /usr/include/eigen3 \
	   $(subst -I,-isystem ,$(filter -I%,$(shell pkg-config --cflags ompl))) \
	   $(SANFLAGS)
HARDEN	=
LDFLAGS	= -Wl,--gc-sections,--as-needed $(HARDEN) $(SANFLAGS)

# The parts, in the order data flows.
# libinterp has a floor for each use: see docs/architecture.md.
CORE	:= $(wildcard libinterp/core/*/*.c)
COMPILE	:= $(wildcard libinterp/compile/*/*.c)
# Built into the reader, in this order: a base is in front of what begins from it.
DIALECTS := generic linuxcnc heekscnc fanuc-sinker sodick-sinker \
	    charmilles-robofil charmilles-cmd skd2 sodick-wire chmer \
	    fanuc-wire mastercam-wire makino mitsubishi-wire \
	    charmilles-robofil-440 agie \
	    agievision 3b 4b
MODEL	:= $(wildcard libinterp/model/*.c)
INTERP	:= $(CORE) $(COMPILE) $(MODEL)
# What every program has in common.
COMMON	:= $(wildcard common/*.c)
WORDS	:= $(wildcard daemon/words/*.c)
RT	:= $(wildcard daemon/rt/*.c daemon/rt/*/*.c)
# Of two files for libgpiod, the one for the version that pkg-config finds.
PKG_CONFIG ?= pkg-config
GPIOD	:= $(firstword $(subst ., ,$(shell $(PKG_CONFIG) --modversion libgpiod 2>/dev/null)))
IO	:= $(filter-out daemon/io/gpiod$(if $(filter 1,$(GPIOD)),2,1).c,\
	   $(wildcard daemon/io/*.c))
GPIOD_INC := $(shell $(PKG_CONFIG) --cflags libgpiod 2>/dev/null)
LIBGPIOD := $(shell $(PKG_CONFIG) --libs libgpiod 2>/dev/null || echo -lgpiod)
MODBUS_INC := $(shell $(PKG_CONFIG) --cflags libmodbus 2>/dev/null || echo -I/usr/include/modbus)
CONFIG	:= $(wildcard daemon/config/*.c)
COMPILING := $(wildcard daemon/compiling/*.c)
# The values in force, for the programs that show them: edmd-jobs, edm-panel.
VALUES	:= $(wildcard daemon/values/*.c)
# A job in virtual time: edmsim, edmd-jobs.
VIRTUAL	:= $(wildcard daemon/virtual/*.c)
SHM	:= $(wildcard daemon/shm/*.c)
SETUP	:= $(wildcard daemon/setup/*.c)
EDMD	:= $(wildcard daemon/edmd/*.c)
JOBS	:= $(wildcard daemon/jobs/*.c)
SIGN	:= $(wildcard messages/sign/*.c)
LOGGER	:= $(wildcard daemon/logger/*.c)
CLIENT	:= $(wildcard clients/client/*.c)
SIM	:= $(wildcard clients/sim/*.c)
CTL	:= $(wildcard clients/ctl/*.c)
PLOT	:= $(wildcard clients/plot/*.c)
PLAN	:= $(wildcard clients/plan/*.c)
# The two libraries for which a little C++ is needed: OMPL and Eigen.
PLAN_CC	:= $(wildcard clients/plan/*.cc)
PANEL_C	:= $(wildcard clients/panel/*.c)
SHEETS	:= $(wildcard clients/plot/*.gp)
UNIT	:= $(wildcard tests/unit/test_*.c)
BENCH	:= $(wildcard tests/bench/*.c)
PEER	:= $(wildcard tests/peer/*.c)
# Methods that were compared and lost: no program uses them.
TRIED	:= $(wildcard tests/experiments/tried/*.c)

# What a part may include.  A header not on its list does not resolve.
CORE_H		= -Ilibinterp/core/include
COMPILE_H	= -Ilibinterp/compile/include
MODEL_H		= -Ilibinterp/model/include
INC_common	= -Icommon $(CORE_H)
INC_core	= $(CORE_H) -Ilibinterp/core
INC_compile	= $(COMPILE_H) -Ilibinterp/compile -Icommon $(INC_core)
INC_model	= $(MODEL_H) -Ilibinterp/model $(CORE_H)
WORDS_H		= -Idaemon/words
INC_words	= $(WORDS_H) $(CORE_H)
INC_rt		= -Idaemon/rt -Idaemon/io $(WORDS_H) $(CORE_H)
INC_io		= -Idaemon/io -Icommon -Idaemon/config $(WORDS_H) $(CORE_H) $(GPIOD_INC) $(MODBUS_INC)
INC_config	= -Idaemon/config -Idaemon/rt -Idaemon/io $(WORDS_H) $(CORE_H)
INC_compiling	= -Idaemon/compiling -Idaemon/config $(WORDS_H) $(CORE_H) $(COMPILE_H)
INC_shm		= -Idaemon/shm -Icommon $(WORDS_H)
INC_virtual	= -Idaemon/virtual $(INC_config) $(COMPILE_H)
INC_values	= -Idaemon/values -Idaemon/shm $(INC_compiling)
INC_setup	= -Idaemon/setup -Icommon
INC_logger	= -Idaemon/logger -Icommon -Imessages/sign
INC_edmd	= -Idaemon/edmd $(INC_logger) -Icommon -Idaemon/shm -Idaemon/setup $(INC_config)
INC_jobs	= -Idaemon/jobs $(INC_logger) -Icommon $(WORDS_H) $(INC_values) $(INC_virtual) $(MODEL_H) -Imessages/sign -I$(B)/messages
INC_sign	= -Imessages/sign -Icommon
INC_client	= -Iclients/client -Icommon $(WORDS_H) -Imessages/sign -I$(B)/messages
INC_sim		= -Iclients/sim -Icommon -Iclients/plot $(INC_virtual) $(INC_compiling) $(MODEL_H)
INC_ctl		= -Iclients/ctl -Icommon -Idaemon/config -Idaemon/io -Iclients/plot -Idaemon/shm $(WORDS_H) $(CORE_H) $(MODEL_H) $(INC_client)
INC_dds		= -Iclients/dds $(INC_client) -Icommon -Idaemon/shm $(WORDS_H) -Idaemon/config $(CORE_H) -I$(B)/messages
INC_panel	= -Iclients/panel -Icommon $(WORDS_H) $(INC_values) -Iclients/client -Imessages/sign
INC_libinterp	= $(INC_compile) $(INC_model)
INC_plan	= -Iclients/plan -Icommon $(INC_config) $(INC_compiling)
INC_unit	= -Itests/unit -Itests/data -Itests/experiments $(INC_virtual) $(INC_edmd) $(INC_jobs) $(INC_libinterp) -Iclients/plan -Iclients/panel -Iclients/ctl $(MODBUS_INC)
INC_bench	= -Itests/data -Itests/experiments $(INC_edmd) $(INC_compiling) $(MODEL_H)
INC_system	= -Idaemon/io
INC_peer	= -Itests/data $(CORE_H) $(COMPILE_H)
part = $(if $(filter common,$(firstword $(subst /, ,$1))),common,$(word 2,$(subst /, ,$1)))

obj	= $(patsubst %.c,$(B)/%.o,$1)
CORE_A	 := $(B)/libinterp-core.a
COMPILE_A := $(B)/libinterp-compile.a
MODEL_A	 := $(B)/libinterp-model.a
TRIED_A	 := $(B)/tests-tried.a
COMMON_A := $(B)/common.a
INTERP_A := $(COMPILE_A) $(MODEL_A) $(CORE_A) $(COMMON_A)
WORDS_O	 := $(call obj,$(WORDS))
# Words for people, which the cycle must not make.
TEXT_O	 := $(B)/daemon/words/process_text.o $(B)/daemon/words/cia402.o
RT_O	 := $(call obj,$(RT)) $(filter-out $(TEXT_O),$(WORDS_O))
IO_O	 := $(call obj,$(IO))
SIM_IO_O := $(filter-out %/can402_lines.o %/gpio.o %/gpio_open.o %/gpio_axes.o %/quadrature.o %/encoder.o %/adc.o %/edges.o %/gpiod1.o %/gpiod2.o %/chips.o %/generator_lines.o %/generator_modbus.o %/generator_open.o,$(IO_O))
LINES_O	 := $(filter %/gpiod1.o %/gpiod2.o,$(IO_O))
CONFIG_O := $(call obj,$(CONFIG)) $(TEXT_O)
COMPILING_O := $(call obj,$(COMPILING))
VIRTUAL_O := $(call obj,$(VIRTUAL))
SHM_O	 := $(call obj,$(SHM)) $(WORDS_O)
SIGN_O	 := $(call obj,$(SIGN))
LOGGER_O	 := $(call obj,$(LOGGER)) $(B)/common/plain.o
SETUP_O	 := $(call obj,$(SETUP))
LCM_O	 := $(B)/messages/edm_lcm.o
DDS_O	 := $(B)/messages/edm.o

PROGRAMS := $(B)/edmsim $(B)/edmd $(B)/edmd-jobs $(B)/edmctl $(B)/edm-dds $(B)/edm-fleet \
	    $(B)/edm-panel $(B)/edm-plan
UNIT_X	 := $(UNIT:tests/unit/%.c=$(B)/unit/%)
BENCH_X	 := $(BENCH:tests/bench/%.c=$(B)/bench/%)
PEER_X	 := $(PEER:tests/peer/%.c=$(B)/peer/%)

all: $(PROGRAMS) $(SHEETS:clients/plot/%=$(B)/share/edmd/%)

# Read by the programs when they draw, so it stands beside them.
$(B)/share/edmd/%: clients/plot/%
	@mkdir -p $(@D)
	$(Q)$(call whole,cp $<)

# -- Compile ------------------------------------------------------------------

# What is made has another name until it is whole: a kill leaves nothing that
# would be taken for it later.  $1: the command, up to the name of what it makes.
whole	= $1 $@.new && mv $@.new $@
# The same for an object, with the names of the headers it was made from.
object	= $1 -MMD -MP -MT $@ -MF $@.d.new -c -o $@.new $< && \
	  mv $@.d.new $@.d && mv $@.new $@
.DELETE_ON_ERROR:

$(B)/dialect_files.c: $(DIALECTS:%=dialects/%.ini) Makefile
	$(call say,GEN,$@)
	@mkdir -p $(@D)
	$(Q){ echo '#include "code/dialect.h"'; \
		echo 'const struct dialect_file nc_dialect_files[] = {'; \
		for d in $(DIALECTS); do echo "{ \"$$d\","; \
			sed 's/[\\"]/\\&/g; s/.*/"&\\n"/' dialects/$$d.ini; \
			echo '},'; done; echo '{ 0, 0 } };'; } > $@.new
	$(Q)mv $@.new $@

$(B)/dialect_files.o: $(B)/dialect_files.c
	$(call say,CC,$<)
	$(Q)$(call object,$(CC) $(CFLAGS) -Wno-overlength-strings $(INC_compile))

$(B)/%.o: %.c
	$(call say,CC,$<)
	@mkdir -p $(@D)
	$(Q)$(call object,$(CC) $(CFLAGS) $(INC_$(call part,$<)))

$(B)/%.o: %.cc
	$(call say,CXX,$<)
	@mkdir -p $(@D)
	$(Q)$(call object,$(CXX) $(CXXFLAGS) $(INC_$(call part,$<)))

ifneq ($(OPT),$(FAST))
# From text to program there are many short loops over the axes, and roots whose
# errno nobody asks for.
$(call obj,$(wildcard $(addprefix libinterp/compile/,code/scan_again.c code/scan.c \
	path/*.c speed/*.c)) libinterp/core/pulse/arc.c): OPT = -O3 -fno-math-errno
# Nothing here may trap, so several ticks of an arc may be rounded at a time.
$(call obj,libinterp/core/pulse/arc.c): OPT += -fno-trapping-math
# Over two to four columns vectors take more than they give.
$(call obj,$(wildcard $(addprefix libinterp/compile/,path/build.c speed/*.c))): \
	OPT += -fno-tree-vectorize
endif
$(B)/tests/unit/%.o: OPT = $(FAST)

# What runs each period is optimised as a whole where it is linked into a program.
# Its objects have machine code too, for all that is linked without that.  Not for
# sanitizers, nor with a compiler that cannot do both.
LTO	?= $(if $(filter 1,$(SAN) $(TSAN))$(findstring clang,$(CC)),0,1)
ifeq ($(LTO),1)
# The walks are loops of their own, and some would be slower.
LTO_O	:= $(call obj,$(filter-out libinterp/core/pulse/%,$(CORE)) $(RT) \
	   $(IO) $(WORDS))
$(LTO_O): CFLAGS += -flto -ffat-lto-objects
# What was compiled before there was this would be linked as it is.
$(LTO_O): Makefile
LTO_LINK = -fno-lto
$(B)/edmd $(B)/edmsim $(B)/bench/count $(B)/bench/cycle $(B)/bench/points: \
	LTO_LINK = -flto=auto $(OPT)
endif

# Generated messages: compiled without our warnings, they are not ours.
LCM_TYPES := $(shell sed -n 's/^struct \([a-z_]*_t\).*/\1/p' messages/edm.lcm 2>/dev/null)
LCM_C	  := $(LCM_TYPES:%=$(B)/messages/edm_%.c)

$(B)/messages/lcm.stamp: messages/edm.lcm
	$(call say,LCMGEN,$<)
	@mkdir -p $(@D)
	$(Q)lcm-gen -c --c-cpath $(B)/messages --c-hpath $(B)/messages $<
	$(Q)lcm-gen -p --ppath $(B)/python $<
	@touch $@

$(B)/messages/edm_lcm.o: $(B)/messages/lcm.stamp
	$(call say,CC,$(@F))
	$(Q)cat $(LCM_C) > $(@D)/edm_lcm_all.c
	$(Q)$(call whole,$(CC) -std=gnu11 -g $(OPT) -w $(SANFLAGS) -I$(@D) \
		-c $(@D)/edm_lcm_all.c -o)

# Without -t a reader in the network whose type differs ends the process in which
# the library looks at that type.
$(B)/messages/edm.c: messages/edm.idl
	$(call say,IDLC,$<)
	@mkdir -p $(@D)/new
	$(Q)idlc -t -o $(@D)/new $<
	$(Q)mv $(@D)/new/edm.h $(@D)
	$(Q)mv $(@D)/new/edm.c $(@D)

$(B)/messages/edm.o: $(B)/messages/edm.c
	$(call say,CC,$(@F))
	$(Q)$(call object,$(CC) -std=gnu11 -g $(OPT) -w $(SANFLAGS) -I$(@D))

$(call obj,$(JOBS) $(CTL) $(CLIENT)): | $(B)/messages/lcm.stamp
$(call obj,$(wildcard clients/dds/*.c)): | $(B)/messages/edm.c

# -- Link ---------------------------------------------------------------------

define link
$(call say,LD,$@)
@mkdir -p $(@D)
$(Q)$(call whole,$(CC) $(LDFLAGS) $(LTO_LINK) $(filter %.o,$^) \
	$(filter %.a,$^) $1 -o)
endef

# An archive for each floor of libinterp: what links one can reach no other.
define archive
$(call say,AR,$@)
@rm -f $@.new
$(Q)$(AR) rcs $@.new $^
$(Q)mv $@.new $@
endef

$(COMMON_A): $(call obj,$(COMMON))
	$(archive)
$(CORE_A): $(call obj,$(CORE))
	$(archive)
$(COMPILE_A): $(call obj,$(COMPILE)) $(B)/dialect_files.o
	$(archive)
$(MODEL_A): $(call obj,$(MODEL))
	$(archive)
$(TRIED_A): $(call obj,$(TRIED))
	$(archive)

$(B)/edmsim: $(call obj,$(SIM) $(PLOT)) $(VIRTUAL_O) $(COMPILING_O) $(CONFIG_O) $(SIM_IO_O) $(RT_O) $(INTERP_A)
	$(call link,-linih -ljansson -lpthread -lnlopt -lm)

$(B)/edmd: $(call obj,$(EDMD)) $(LOGGER_O) $(SETUP_O) $(SHM_O) $(CONFIG_O) $(IO_O) $(RT_O) $(CORE_A) $(COMMON_A)
	$(call link,-linih -lsystemd $(LIBGPIOD) -lmodbus -lpthread -lm)

# For tests: the lines of a chip are bytes of a file.
$(B)/tests/edmd-lines: $(B)/tests/system/lines_file.o $(call obj,$(EDMD)) $(LOGGER_O) $(SETUP_O) $(SHM_O) $(CONFIG_O) $(filter-out $(LINES_O),$(IO_O)) $(RT_O) $(CORE_A) $(COMMON_A)
	$(call link,-linih -lsystemd -lmodbus -lpthread -lm)

$(B)/edmd-jobs: $(call obj,$(JOBS) $(VALUES) $(LOGGER)) $(SIGN_O) $(SHM_O) $(VIRTUAL_O) $(COMPILING_O) $(CONFIG_O) $(SIM_IO_O) $(RT_O) $(LCM_O) $(INTERP_A)
	$(call link,-linih -ljansson -llcm -lsqlite3 -lsodium -lsystemd -lm)

$(B)/edmctl: $(call obj,$(CTL) $(CLIENT) $(SIGN) $(PLOT)) $(LINES_O) $(SHM_O) $(CONFIG_O) $(LCM_O) $(MODEL_A) $(CORE_A) $(COMMON_A)
	$(call link,-linih -llcm -lsodium -ljansson -lz -lncursesw -ltinfo $(LIBGPIOD) -lm)

$(B)/edm-dds: $(call obj,$(addprefix clients/dds/,edm-dds.c post.c relay.c reports.c scope.c watch.c topic.c tool.c) $(CLIENT)) $(SIGN_O) $(SHM_O) $(CONFIG_O) $(LCM_O) $(DDS_O) $(CORE_A) $(COMMON_A)
	$(call link,-lddsc -linih -llcm -lsodium -ljansson -lm)

$(B)/edm-fleet: $(call obj,$(addprefix clients/dds/,edm-fleet.c dispatch.c hall.c ledger.c post.c scope_record.c sink.c table.c topic.c tool.c) $(CLIENT)) $(SIGN_O) $(SHM_O) $(LCM_O) $(DDS_O) $(COMMON_A)
	$(call link,-lddsc -ljansson -lsqlite3 -llcm -lsodium -lm)

$(B)/edm-panel: $(call obj,$(PANEL_C) $(VALUES) $(CLIENT)) $(SIGN_O) $(SHM_O) $(COMPILING_O) $(CONFIG_O) $(LCM_O) $(COMPILE_A) $(CORE_A) $(COMMON_A)
	$(call link,-lwebsockets -lssl -linih -llcm -lsodium -ljansson -lsystemd -lm)

$(B)/edm-plan: $(call obj,$(PLAN)) $(PLAN_CC:%.cc=$(B)/%.o) $(COMPILING_O) $(CONFIG_O) $(SIM_IO_O) $(RT_O) $(INTERP_A) $(COMMON_A)
	$(call link,-lompl -lstdc++ -ladmesh -lglpk -linih -ljansson -lpthread -lm)

# Of edm-plan, without its main().
PLAN_CORE := $(call obj,$(addprefix clients/plan/,mesh.c tree.c tri.c \
	     apart.c box.c near.c near_set.c motion.c sweep.c prove.c proved.c \
	     spread.c))

$(B)/unit/test_plan_core $(B)/unit/test_plan_bounds $(B)/unit/test_plan_near: $(PLAN_CORE)

$(B)/unit/test_plan_lp: $(call obj,clients/plan/lp.c)
$(B)/unit/test_plan_lp: UNIT_LIBS = -lglpk

$(B)/unit/test_corridor: $(PLAN_CC:%.cc=$(B)/%.o)
$(B)/unit/test_corridor: UNIT_LIBS = -lompl -lstdc++

# Of edmd itself, without its main().
$(B)/unit/test_resume $(B)/unit/test_resume_mcodes $(B)/unit/test_kill_anywhere: $(call obj,$(addprefix daemon/edmd/,resume.c publish.c programs.c key.c crossing.c log.c)) $(LOGGER_O)

$(B)/unit/test_loop_commands: $(call obj,$(addprefix daemon/edmd/,commands.c loop.c plc_loop.c publish.c programs.c key.c crossing.c log.c)) $(LOGGER_O)
$(B)/unit/test_loop_commands: UNIT_LIBS = -lsystemd

# Of what stands in front of edmd-jobs.
$(B)/unit/test_seal $(B)/unit/test_trust: $(SIGN_O) $(LCM_O) $(LOGGER_O) $(call obj,$(addprefix daemon/jobs/,trust.c jobs_log.c))
$(B)/unit/test_seal $(B)/unit/test_trust: UNIT_LIBS = -lsodium -llcm -lsystemd
$(call obj,tests/unit/test_seal.c): | $(B)/messages/lcm.stamp

# Of the store, without the rest of edmd-jobs.
$(B)/unit/test_store $(B)/unit/test_store_electrode $(B)/unit/test_store_turn: $(SIGN_O) $(LOGGER_O) $(call obj,$(wildcard daemon/jobs/store*.c) daemon/jobs/trust.c daemon/jobs/jobs_log.c)
$(B)/unit/test_store $(B)/unit/test_store_electrode $(B)/unit/test_store_turn: UNIT_LIBS = -lsqlite3 -lsodium -lsystemd

$(B)/unit/test_checkpoint: $(LOGGER_O) $(call obj,$(wildcard daemon/jobs/checkpoint.c daemon/jobs/checkpoint_block.c) daemon/jobs/jobs_log.c)
$(B)/unit/test_checkpoint: UNIT_LIBS = -lsodium -lsystemd

$(B)/unit/test_doctor_rt: $(call obj,clients/ctl/doctor_rt.c)
$(B)/unit/test_share: $(call obj,clients/panel/share.c)
$(B)/unit/test_frames: $(call obj,clients/panel/frames.c)
$(B)/unit/test_frames: UNIT_LIBS = -lssl

# The sockets and the lines of an encoder are the test's own.
$(B)/unit/test_can_queue: UNIT_LIBS = -Wl,--wrap=can_socket_open
# Looks at a program are counted.
$(B)/unit/test_plc_link: UNIT_LIBS = -Wl,--wrap=can_socket_send
$(B)/unit/test_ground: UNIT_LIBS = -Wl,--wrap=interp_program_any_at
$(B)/unit/test_encoder: UNIT_LIBS = $(foreach f,events get release,-Wl$(,)--wrap=lines_$f)

$(B)/unit/%: $(B)/tests/unit/%.o $(SETUP_O) $(SHM_O) $(VIRTUAL_O) $(COMPILING_O) $(CONFIG_O) $(IO_O) $(RT_O) $(TRIED_A) $(INTERP_A)
	$(call link,-lcmocka -linih $(LIBGPIOD) -lmodbus $(UNIT_LIBS) -lpthread -lnlopt -lm)

$(B)/tests/bench/plan.o: INC_bench += -Iclients/plan
$(B)/bench/plan: $(B)/tests/bench/plan.o $(filter-out %/main.o,$(call obj,$(PLAN))) $(PLAN_CC:%.cc=$(B)/%.o) $(COMPILING_O) $(CONFIG_O) $(SIM_IO_O) $(RT_O) $(INTERP_A) $(COMMON_A)
	$(call link,-lompl -lstdc++ -ladmesh -lglpk -linih -ljansson -lpthread -lm)

$(B)/tests/bench/spark.o: INC_bench += -Itests/unit $(MODBUS_INC)
$(B)/bench/wait $(B)/bench/spark: $(SETUP_O)
$(B)/bench/%: $(B)/tests/bench/%.o $(SHM_O) $(COMPILING_O) $(CONFIG_O) $(IO_O) $(RT_O) $(TRIED_A) $(INTERP_A)
	$(call link,-linih $(LIBGPIOD) -lmodbus $(if $(findstring curves,$@),-lsisl) \
		$(if $(findstring spark,$@),-lcmocka) -lpthread -lnlopt -lm)

$(B)/peer/%: $(B)/tests/peer/%.o $(INTERP_A)
	$(call link,$(if $(findstring sisl,$@),-lsisl) -lnlopt -lm)

# -- The panel's page ----------------------------------------------------------

# Built by npm in a folder of its own, from a lock file that names no address.
WEB	:= clients/panel/web
WEB_SRC	:= $(wildcard $(WEB)/src/* $(WEB)/public/* $(WEB)/*.json $(WEB)/*.js \
	   $(WEB)/*.mjs $(WEB)/index.html $(WEB)/.npmrc)

panel: $(B)/panel.stamp $(B)/nodesets.stamp

# Of the OPC Foundation, for edm-gateway: from the same lock file.
NODESETS := $(patsubst %,Opc.Ua.%.NodeSet2.xml,Di IA Machinery MachineTool)
$(B)/nodesets.stamp: $(B)/web/node_modules.stamp
	$(Q)mkdir -p $(B)/nodesets
	$(Q)cd $(B)/web/node_modules/node-opcua-nodesets/nodesets && \
		cp $(NODESETS) '$(abspath $(B))/nodesets'
	@touch $@

$(B)/web/node_modules.stamp: $(WEB)/package.json $(WEB)/package-lock.json
	@tests/setup panel
	$(call say,NPM,$(WEB))
	$(Q)mkdir -p $(B)/web
	$(Q)cp $(WEB)/package.json $(WEB)/package-lock.json $(WEB)/.npmrc $(B)/web
	$(Q)tests/setup modules $(B)/web
	$(Q)touch $@

$(B)/panel.stamp: $(B)/web/node_modules.stamp $(WEB_SRC) $(B)/edm-panel
	$(call say,VITE,$(B)/panel)
	$(Q)rm -rf $(B)/web/src $(B)/web/public
	$(Q)cp -r $(WEB)/src $(WEB)/public $(WEB)/index.html $(WEB)/*.js \
		$(WEB)/*.mjs $(WEB)/tsconfig.json $(B)/web
	$(Q)$(B)/edm-panel --print-words > $(B)/web/src/machine.json
	$(Q)cd $(B)/web && npm run --silent check && \
		EDM_PANEL_OUT='$(abspath $(B))/panel' npm run --silent build -- \
			--logLevel warn && node finish.mjs '$(abspath $(B))/panel'
	@touch $@

# -- The commands -------------------------------------------------------------

# PANEL=1: with the operator's page, for a browser of this host; PORT=7680.
PANEL	?= 0
PORT	?= 7680

demo:
	@tests/setup build
	@$(if $(filter 1,$(PANEL)),tests/setup panel)
	@$(MAKE) --no-print-directory all $(if $(filter 1,$(PANEL)),panel) || \
		tests/setup failed
	@EDM_BUILD=$(B) PORT=$(PORT) \
		$(if $(filter 1,$(PANEL)),examples/demo-panel,tests/netns examples/demo)

demo-plan:
	@tests/setup build
	@$(MAKE) --no-print-directory $(B)/edm-plan $(B)/edmsim
	@EDM_BUILD=$(B) examples/demo-plan

# Everything: ends with the runner's own lines.  Random tests have a seed here, so
# that what fails has been changed, and fewer rounds of it; `make run-units`, `make
# invariants`, `make fuzz` and the tests run alone go on to look with others.
check:
	@tests/stage check setup
	@tests/setup check
	@tests/stage check build
	@$(MAKE) --no-print-directory -j$(SIDE) all units panel vm \
		$(B)/bench/count WERROR=1 || tests/setup failed
	@tests/stage check lint
	@$(MAKE) --no-print-directory -j$(SIDE) lint
	@tests/stage check units
	@EDM_SEED=1 EDM_SHARE=4 $(MAKE) --no-print-directory \
		-j$(SIDE) run-units
	@tests/stage check beside
	@rm -f $(COUNTS)
	@$(MAKE) --no-print-directory -j$$(($(SIDE) + 1)) $(BESIDE:%=beside-%)
	@tests/stage check page
	@EDM_COUNTS_ALL=1 $(PYTEST) $(PANEL_TESTS)

# The tests of the daemons wait: each takes a tenth of a core.  So they run beside
# all that computes, which has a core for each job.
BESIDE	= system vm sim san tsan count fuzz clang
COUNTS	= $(B)/check.counts
PYTEST	= MAKEFLAGS= EDM_BUILD=$(B) EDM_SEED=1 EDM_COUNTS=$(COUNTS) $(NETNS) \
	  .venv/bin/pytest -q

# Several processes of pytest: a whole file belongs to one of them, and each has a
# network of its own (tests/conftest.py).
beside-system:
	@$(PYTEST) -n $$((2 * $(SIDE))) --dist loadfile --no-loadscope-reorder \
		$(SYSTEM_TESTS)
beside-sim:
	@$(PYTEST) tests/sim
beside-vm:
	@$(PYTEST) $(VM_TESTS)
beside-san:
	@EDM_SEED=2 EDM_SHARE=2 $(MAKE) --no-print-directory SAN=1 run-units
beside-tsan:
	@$(MAKE) --no-print-directory TSAN=1 run-crossings
beside-fuzz:
	@$(MAKE) --no-print-directory fuzz FUZZ_SEED=1 FUZZ_RUNS=50000 FUZZ_S=20
beside-count: run-count
beside-clang: clang

# Of the virtual machine's tests those that were seen to pass again and again, some
# 8 minutes.  The others, encoder and adc among them, are in `make check-vm`.
VM_TESTS = $(patsubst %,tests/vm/test_%.py,plain systemd can402 torture)

# A browser is driven in the tests' own process; LCM has one for itself.  They run
# alone: a browser needs both cores at times.
PANEL_TESTS = $(wildcard tests/system/test_panel*.py)

SYSTEM_TESTS = tests/system $(PANEL_TESTS:%=--ignore %)

# For somebody who changes code: most of what goes wrong, in 90 s.
SLOW_UNITS = arcs cycle_random limits identify contouring taper \
	     contour_random curve scurve
SLOW_X	= $(SLOW_UNITS:%=$(B)/unit/test_%)

# FOLDER: the unit tests that belong to it, without the slow ones.
FOLDER	?=
QUICK_X	= $(filter-out $(SLOW_X),$(UNITS_OF:%=$(B)/unit/%))
ifneq ($(FOLDER),)
quick: UNITS_OF = $(shell tests/units-of '$(FOLDER)')
quick:
	@$(if $(QUICK_X),,echo "no quick unit test belongs to $(FOLDER)"; exit 65)
	@EDM_SEED=1 EDM_SHARE=4 $(MAKE) --no-print-directory -k -j$(SIDE) \
		WERROR=1 $(QUICK_X:%=%.run)
else
quick:
	@tests/stage quick build
	@tests/setup check
	@$(MAKE) --no-print-directory -j2 all units WERROR=1
	@tests/stage quick lint
	@$(MAKE) --no-print-directory lint
	@tests/stage quick units
	@EDM_SEED=1 EDM_SHARE=4 $(MAKE) --no-print-directory \
		-j$(SIDE) run-units UNIT_X="$(filter-out $(SLOW_X),$(UNIT_X))"
	@tests/stage quick tests
	@EDM_BUILD=$(B) $(NETNS) .venv/bin/pytest -q tests/system/test_erode.py
endif

# As root, while build/edmd runs: docs/debugging.md.
.PHONY: trace
TRACE_S	?= 5
trace:
	@tests/trace $(B)/edmd $(TRACE_S) $(B)/trace

# What make would run is always looked at anew: it takes some seconds.
.PHONY: compile_commands.json
compile_commands.json:
	@$(MAKE) --no-print-directory -Bn V=1 all units | \
		tests/compile-commands > $@.new
	@mv $@.new $@

# What the virtual machine of tests/vm boots from, and edmd on libgpiod 2.x.
PC2	= $(abspath build-vm/libgpiod2)

# Where there can be none, its tests are skipped with what is in build-vm/lacks.
vm: all
	@mkdir -p build-vm
	@tests/vm/lacks > build-vm/lacks
	@if [ -s build-vm/lacks ]; then echo "  SKIP    the virtual machine:" \
		"needs $$(cat build-vm/lacks)"; else \
		$(MAKE) --no-print-directory vm-parts; fi

vm-parts:
	@tests/setup vm
	@$(MAKE) --no-print-directory -C tests/vm B=$(abspath build-vm)
	@$(MAKE) --no-print-directory B=build-gpiod2 build-gpiod2/edmd \
		PKG_CONFIG="env PKG_CONFIG_SYSROOT_DIR=$(PC2) PKG_CONFIG_LIBDIR=$$(\
		echo $(PC2)/usr/lib/*/pkgconfig) pkg-config"

# Strict drives of another hand, powered off at random: too long for each check.
check-strict:
	@tests/setup check
	@$(MAKE) --no-print-directory vm
	@EDM_BUILD=$(B) .venv/bin/pytest -q tests/vm/test_strict.py \
		tests/vm/test_unruly.py

check-vm:
	@tests/setup check
	@$(MAKE) --no-print-directory vm
	@EDM_BUILD=$(B) $(NETNS) .venv/bin/pytest -q tests/vm

# The fuzzers' own objects too: who changes a type hears it here, not at the end.
FUZZ_O	= $(patsubst %.c,$(B)/%.o,$(wildcard tests/fuzz/*.c))
units: $(UNIT_X) $(PEER_X) $(B)/loopback.so $(FUZZ_O)

# Tests run in a network of their own; where there is none, by loopback.
NETNS	= EDM_LOOPBACK='$(abspath $(B))' tests/netns

$(B)/loopback.so: tests/loopback.c
	$(call say,CC,$<)
	$(Q)$(call whole,$(CC) -std=gnu11 -D_GNU_SOURCE -O2 $(WARN) -shared \
		-fPIC $< -o)

# Those that take longest begin first.
run-units: $(addsuffix .run,$(filter $(SLOW_X),$(UNIT_X)) \
	   $(filter-out $(SLOW_X),$(UNIT_X)) $(PEER_X))

$(B)/%.run: $(B)/%
	$(Q)tests/one-unit $<

# 500 kills of edmd, edmd-jobs and both around every verb: half an hour.
KILLS ?= 500
.PHONY: kills hostile
kills: all
	@tests/setup check
	$(Q)EDM_BUILD=$(B) EDM_KILLS=$(KILLS) $(NETNS) .venv/bin/pytest -q -s \
		tests/system/test_kills.py

# QEMU killed at random instants, 60 times in each of five jobs; then the disk cut
# between 300 pairs of its writes: two to three hours on an idle host.
CUTS ?= 300
.PHONY: torture
torture:
	@tests/setup check
	@$(MAKE) --no-print-directory vm
	$(Q)EDM_BUILD=$(B) EDM_CUTS=$$(($(CUTS) / 5)) $(NETNS) \
		.venv/bin/pytest -q -s tests/vm/test_torture.py
	$(Q)EDM_BUILD=$(B) EDM_CUTS=$(CUTS) $(NETNS) \
		.venv/bin/pytest -q -s tests/vm/test_disk_cut.py

# 100,000 packets from another host, and how late the cycle woke meanwhile.
HOSTILE ?= 100000
hostile: all
	@tests/setup check
	$(Q)EDM_BUILD=$(B) EDM_HOSTILE=$(HOSTILE) $(NETNS) .venv/bin/pytest -q \
		-s tests/system/test_two_hosts.py

# What holds in every cycle, over ten million random ones; SEED=n repeats one.
invariants: $(B)/unit/test_cycle_random
	$(Q)$(if $(SEED),EDM_SEED=$(SEED)) $<

# Ten thousand random contours of a wire against another geometry, a tenth as many
# with other leads, a hundredth with a taper, more with faces that lean to any
# side: half an hour.
WIRE_RUNS ?= 10000
WIRE_TEST = EDM_BUILD=$(B) $(if $(SEED),EDM_SEED=$(SEED)) \
	EDM_RUNS=$$(( $(WIRE_RUNS) / $(1) )) .venv/bin/pytest -q -s tests/sim
wire-random: $(B)/edmsim
	@tests/setup check
	$(Q)$(call WIRE_TEST,1)/test_wire_random.py
	$(Q)$(call WIRE_TEST,10)/test_wire_leads.py
	$(Q)$(call WIRE_TEST,100)/test_wire_taper.py -k "tapers or taper"
	$(Q)$(call WIRE_TEST,20)/test_wire_faces.py -k faces
	$(Q)$(call WIRE_TEST,100)/test_wire_arcs.py

# Random programs of six classes, each walked: what is asked of each axis, within the
# rounding, by a linear program that knows nothing of how speeds were found.
SPEED_RUNS ?= 80
.PHONY: speed-oracle
speed-oracle: $(B)/edmsim
	@tests/setup check
	$(Q)EDM_BUILD=$(B) $(if $(SEED),EDM_SEED=$(SEED)) EDM_RUNS=$(SPEED_RUNS) \
		.venv/bin/pytest -q -rP -n $(SIDE) tests/sim/test_speed_oracle.py

# Each machine file that is shipped, and its jobs, for so many seeds: 20 min.
SHIPPED ?= 100
.PHONY: shipped
shipped: $(B)/edmsim
	@tests/setup check
	$(Q)EDM_BUILD=$(B) EDM_RUNS=$(SHIPPED) .venv/bin/pytest -q \
		tests/sim/test_shipped.py

# What is accepted is walked, there and back: so many random programs of every
# dialect, by every strategy.
RUNS	?= 100000
walkable: $(B)/unit/test_walkable
	$(Q)EDM_RUNS=$(RUNS) $(if $(SEED),EDM_SEED=$(SEED)) $<

# What threads share, under the thread sanitizer.
run-crossings: $(addsuffix .run,$(filter $(B)/unit/test_shm% $(B)/unit/test_stamped,\
	       $(UNIT_X)))

# Another compiler's opinion: warnings are errors, nothing is linked.  A line of an
# axis is "LINE_STEP + axis": two enums, and meant.
CLANGED = $(COMMON) $(INTERP) $(RT) $(IO) $(CONFIG) $(COMPILING) $(VALUES) $(SHM) \
	  $(SETUP) $(EDMD) $(JOBS) $(SIM) $(CTL) $(PLOT) $(PANEL_C) $(PLAN) \
	  $(wildcard clients/dds/*.c)
clang: $(CLANGED:%=%.clang)

%.clang: %
	$(call say,CLANG,$<)
	$(Q)clang -fsyntax-only -Werror $(filter-out -g,$(CFLAGS)) \
		-Wno-enum-enum-conversion $(sort $(INC_edmd) $(INC_io) $(INC_jobs) \
		$(INC_sim) $(INC_ctl) $(INC_dds) $(INC_panel) $(INC_plan) \
		$(INC_libinterp)) $<

bench-plan:
	@$(MAKE) --no-print-directory $(B)/edm-plan $(B)/bench/plan
	@EDM_BUILD=$(B) .venv/bin/python tests/bench/plan

# Machines over DDS on this computer, and the cycle beside edm-dds.
HALL	:= 10 30 100
hall: all
	@EDM_BUILD=$(B) tests/netns .venv/bin/python tests/bench/hall $(HALL)
	@EDM_BUILD=$(B) tests/netns .venv/bin/python tests/bench/dds-cycle

bench: vm
	@tests/setup check
	@$(MAKE) --no-print-directory $(BENCH_X)
	@EDM_BUILD=$(B) tests/bench/run

# Instructions, which do not depend on how busy the machine is.  What needs over
# 5 % more than docs/performance.md says fails the check.
.PHONY: count run-count
count: $(B)/bench/count
	@EDM_BUILD=$(B) tests/bench/count --parts $(B)/parts.md > $(B)/count.md
	@docs/put-table $(B)/count.md docs/performance.md
	@docs/put-table $(B)/parts.md docs/performance.md
	@cat $(B)/count.md $(B)/parts.md

run-count: $(B)/bench/count
	@EDM_BUILD=$(B) tests/bench/count --check docs/performance.md

# System calls of edmd, which tests/system/test_calls.py holds to what is written.
.PHONY: calls
calls: $(B)/edmd $(B)/edmd-jobs
	@tests/setup check
	@EDM_BUILD=$(B) tests/netns .venv/bin/python tests/system/calls.py > $(B)/calls.md
	@docs/put-table $(B)/calls.md docs/performance.md
	@cat $(B)/calls.md

include tests/experiments/Makefile

# Which file of the cycle calls which; circles have a frame.
callgraph: $(RT_O)
	$(call say,DRAW,docs/pictures/callgraph.svg)
	$(Q)tests/callgraph $(RT_O) > $(B)/callgraph.dot
	$(Q)dot -Tsvg $(B)/callgraph.dot > docs/pictures/callgraph.svg

# The table of faults in the documents, from the table in the code.
faults: $(B)/edmctl
	$(Q)docs/faults $(B)/edmctl > $(B)/faults.md
	$(Q)docs/put-table $(B)/faults.md docs/architecture.md

# What a PLC's tools read, from the tables in the code.
plc-files:
	$(Q).venv/bin/python messages/plc-files messages/edmd.eds messages/edmd.dbc \
		docs/plc-signals.md

# Each from a run of edmsim or of the simulated gap; needs gnuplot and python3.
pictures: $(B)/edmsim $(B)/experiments/process $(B)/experiments/curves
	$(call say,DRAW,docs/pictures)
	$(Q)docs/pictures/staircases $(B)
	$(Q)docs/pictures/orbits $(B)
	$(Q)docs/pictures/wire $(B)
	$(Q)docs/pictures/process $(B)
	$(Q)docs/pictures/curves $(B)
	$(Q)docs/pictures/demo $(B)
	$(Q)docs/pictures/wiring

# What many browsers cost, and how smoothly a long path is drawn: figures.
panel-load: all panel
	@EDM_BUILD=$(B) tests/netns .venv/bin/python tests/bench/panel-load

# A random person beside a random slave on Modbus that sparks: EDM_SECONDS, EDM_SEED.
modbus-person: all $(B)/tests/edmd-lines
	@EDM_BUILD=$(B) tests/netns .venv/bin/python -m pytest -q -s \
		tests/system/modbus_person.py

# The page in Firefox, which is not among what `tests/setup check` installs.
panel-firefox: all panel
	@test -x /usr/bin/firefox-esr || { echo "firefox-esr is not here:" \
		"apt-get install firefox-esr"; exit 1; }
	@EDM_BUILD=$(B) tests/netns .venv/bin/pytest -q \
		tests/system/panel_firefox.py

panel-frames: all panel
	@EDM_BUILD=$(B) tests/netns .venv/bin/python tests/bench/panel-frames

# The panel's pages, in Chromium: needs what `tests/setup check` installs.
pictures-panel: all panel
	@EDM_BUILD=$(B) tests/netns .venv/bin/python docs/pictures/panel

# A seed and a number of runs start from the examples alone, and try the same
# inputs on every machine; without, what earlier runs found is built upon.
FUZZ_S	?= 60
FUZZ_RUNS ?= -1
FUZZ_SEED ?= 0
FUZZ	:= $(patsubst tests/fuzz/%.c,%,$(wildcard tests/fuzz/fuzz_*.c))
# Not its large rings: they cost milliseconds, and all that is made of them.
SEEDS_fuzz_nc	  = $(filter-out %/identify.ngc,$(wildcard examples/*.ngc)) \
		    tests/fuzz/corpus_nc/*
SEEDS_fuzz_threeb = tests/fuzz/corpus_threeb/*
SEEDS_fuzz_tech	  = examples/*.tech examples/*.enc
SEEDS_fuzz_dialect = dialects/*.ini
SEEDS_fuzz_macro  = tests/data/macros/*

fuzz: $(FUZZ:%=run-%)

run-fuzz_%: $(B)/fuzz_%
	$(Q)$(if $(filter-out 0,$(FUZZ_SEED)),rm -rf $(B)/corpus_$*)
	$(Q)mkdir -p $(B)/corpus_$*
	$(Q)$(if $(SEEDS_fuzz_$*),cp $(SEEDS_fuzz_$*) $(B)/corpus_$*/)
	$(Q)$< -seed=$(FUZZ_SEED) -runs=$(FUZZ_RUNS) \
		-max_total_time=$(or $(FUZZ_MOST_S),$(FUZZ_S)) -max_len=4096 $(FUZZ_MORE) \
		-artifact_prefix=$(B)/crashed_$*- -verbosity=0 \
		-print_final_stats=1 $(B)/corpus_$* 2>$<.log || \
		{ tail -n 40 $<.log; exit 1; }
	$(Q)sed -n 's/^stat::number_of_executed_units: */  FUZZ    $*: runs /p' $<.log

# What edmd and its readers are given: the readers of jobs are the larger part.
run-fuzz_status run-fuzz_block run-fuzz_command: \
	FUZZ_MOST_S = $(if $(filter-out 0,$(FUZZ_SEED)),15)
# An input of a few bytes says nothing there, so they are long from the first.
run-fuzz_block run-fuzz_command: FUZZ_MORE = -max_len=512 -len_control=0

# Of our objects, watched; all that are not asked for stay in the archive.
FUZZ_CC	= clang -std=c11 -D_GNU_SOURCE -g -O1 -DEDM_VERSION='"$(VERSION)"' \
	  -fno-sanitize-recover=all
FUZZ_SAN = -fsanitize=fuzzer-no-link$(,)address$(,)undefined
fuzz_o	= $(patsubst %.c,$(B)/watched/%.o,$1)
FUZZ_A	:= $(B)/watched/all.a
INC_fuzz = -Itests/unit $(INC_edmd) $(INC_libinterp)
FUZZ_PARTS = $(INTERP) $(COMMON) $(RT) $(WORDS) $(SETUP) \
	  $(addprefix daemon/shm/,publish.c object.c names.c stop.c) \
	  $(addprefix daemon/edmd/,commands.c crossing.c loop.c publish.c)

$(B)/watched/%.o: %.c
	$(call say,CLANG,$<)
	$(Q)mkdir -p $(@D)
	$(Q)$(call object,$(FUZZ_CC) $(FUZZ_SAN) $(INC_$(call part,$<)))

$(B)/watched/dialect_files.o: $(B)/dialect_files.c
	$(Q)mkdir -p $(@D)
	$(Q)$(call object,$(FUZZ_CC) $(FUZZ_SAN) $(INC_compile))

$(FUZZ_A): $(call fuzz_o,$(FUZZ_PARTS)) $(B)/watched/dialect_files.o
	$(archive)

$(B)/fuzz_%: $(B)/watched/tests/fuzz/fuzz_%.o $(FUZZ_A)
	$(call say,LD,$@)
	$(Q)$(FUZZ_CC) -fsanitize=fuzzer,address,undefined -o $@.new $^ \
		-lcmocka -lnlopt -lpthread -lm
	$(Q)mv $@.new $@

# -- Lint ---------------------------------------------------------------------

HEADERS	 = $(wildcard common/*.h libinterp/*/*/*.h libinterp/*/include/interp/*.h \
	   daemon/*/*.h daemon/rt/*/*.h clients/*/*.h messages/sign/*.h)

# What an edmd must not have: a reader, messages, a database, another floor.
NOT_IN_EDMD = nc_|interp_nc_|interp_build_|interp_threeb_|interp_tech_read|lcm_|sqlite3_|json_|crypto_

# Files of the cycle that call each other in a circle, at most.
CIRCLE_MOST = 3

%.alone: %
	$(Q)$(CC) $(filter-out -g,$(CFLAGS)) -Werror -fsyntax-only \
		$(sort $(INC_edmd) $(INC_jobs) $(INC_sim) $(INC_ctl) $(INC_dds) \
		$(INC_panel) $(INC_plan) $(INC_libinterp)) -x c $<

lint: $(PROGRAMS) $(CORE_A) $(RT_O) $(HEADERS:%=%.alone)
	$(call say,LINT,what the cycle may call)
	$(Q)$(LD) -r -o $(B)/rt.o $(RT_O) --whole-archive $(CORE_A)
	$(Q)objcopy -w -R '.gnu.lto_*' -R '.gnu.debuglto_*' $(B)/rt.o
	$(Q)nm -u $(B)/rt.o | awk '{print $$2}' | sort -u > $(B)/rt.undefined
	$(Q)! grep -vxFf tests/rt-symbols $(B)/rt.undefined
	$(call say,LINT,what edmd must not have)
	$(Q)nm $(B)/edmd | awk '{print $$NF}' > $(B)/edmd.symbols
	$(Q)grep -qx 'interp_cursor_init' $(B)/edmd.symbols
	$(Q)! grep -E '^($(NOT_IN_EDMD))' $(B)/edmd.symbols
	$(Q)! nm $(COMPILE_A) $(MODEL_A) | awk 'NF == 3 && $$2 ~ /[TDRB]/ \
		{print $$3}' | grep -xFf $(B)/edmd.symbols
	$(call say,LINT,each symbol has the prefix of its module)
	$(Q)tests/symbol-prefixes $(B)
	$(call say,LINT,no circle of calls in the cycle)
	$(Q)tests/callgraph --most $(CIRCLE_MOST) $(RT_O)
	$(call say,LINT,no two headers of one name)
	$(Q)! printf '%s\n' $(notdir $(HEADERS)) | sort | uniq -d | grep .
	$(call say,LINT,generated messages stay in their files)
	$(Q)! grep -ln '#include.*edm_.*_t\.h' daemon/*/*.c clients/*/*.c | \
		grep -vE 'daemon/jobs/lcm.c|clients/client/packet.c'
	$(Q)! grep -n '#include "\.\./' -r common daemon libinterp clients tests
	$(call say,LINT,the Python package has the types of messages/edm.lcm)
	$(Q)messages/make-python clients/python/edm/messages.py || { echo \
		"messages/make-python > clients/python/edm/messages.py"; exit 1; }
	$(call say,LINT,no function over 80 lines or 5 parameters)
	$(Q)tests/function-lengths 80 5
	$(call say,LINT,no line over 80 columns)
	$(Q)tests/line-lengths
	$(call say,LINT,what documents name is there)
	$(Q)tests/doc-links

# -- Install ------------------------------------------------------------------

BASH_COMPLETION = share/bash-completion/completions
ZSH_COMPLETION = share/zsh/site-functions

EXAMPLES = $(wildcard examples/*.ini examples/*.ngc examples/*.tech \
	   examples/*.enc examples/*.maps examples/*.st)
SHARED	= messages/edm.lcm messages/edm.idl messages/edmd.eds \
	  messages/edmd.dbc $(SHEETS) systemd/edmd-can.conf
PAPERS	= README.md CHANGELOG.md LICENSE $(wildcard docs/*.md)
DIALECT_FILES = $(wildcard dialects/*.ini)

install: all panel
	$(call say,INSTALL,$(DESTDIR)$(PREFIX))
	$(Q)install -d $(BINDIR) $(UNITDIR) $(INTO)/usr/lib/sysusers.d \
		$(INTO)/usr/lib/udev/rules.d $(INTO)/etc/edmd \
		$(BELOW)/share/man/man1 \
		$(BELOW)/share/man/man8 \
		$(BELOW)/share/edmd
	$(Q)install -m 755 $(PROGRAMS) $(BINDIR)
	$(Q)install -d $(BELOW)/share/edmd/panel/assets
	$(Q)install -m 644 $(B)/panel/*.gz $(BELOW)/share/edmd/panel
	$(Q)install -m 644 $(B)/panel/assets/*.gz \
		$(BELOW)/share/edmd/panel/assets
	$(Q)for u in systemd/*.service.in; do \
		sed 's,@BINDIR@,$(PREFIX)/bin,g' $$u \
			> $(UNITDIR)/$$(basename $$u .in) && \
		chmod 644 $(UNITDIR)/$$(basename $$u .in); done
	$(Q)install -m 644 systemd/edmd.sysusers \
		$(INTO)/usr/lib/sysusers.d/edmd.conf
	$(Q)install -d $(INTO)/usr/lib/tmpfiles.d
	$(Q)install -m 644 systemd/edmd.tmpfiles \
		$(INTO)/usr/lib/tmpfiles.d/edmd.conf
	$(Q)install -m 644 systemd/edmd.rules \
		$(INTO)/usr/lib/udev/rules.d/60-edmd.rules
	$(Q)[ -e $(INTO)/etc/edmd/machine.ini ] || install -m 644 \
		examples/template.ini $(INTO)/etc/edmd/machine.ini
	$(Q)install -m 644 $(SHARED) $(BELOW)/share/edmd
	$(Q)install -d $(BELOW)/share/edmd/examples \
		$(BELOW)/share/doc/edmd
	$(Q)install -m 644 $(EXAMPLES) $(BELOW)/share/edmd/examples
	$(Q)install -m 644 $(PAPERS) $(BELOW)/share/doc/edmd
	$(Q)install -d $(BELOW)/share/edmd/nodesets
	$(Q)install -m 644 $(NODESETS:%=$(B)/nodesets/%) \
		$(BELOW)/share/edmd/nodesets
	$(Q)install -d $(BELOW)/share/edmd/dialects
	$(Q)install -m 644 $(DIALECT_FILES) $(BELOW)/share/edmd/dialects
	$(Q)cd $(BELOW)/share && sha256sum $(addprefix edmd/,$(notdir $(SHARED)) \
		$(addprefix examples/,$(notdir $(EXAMPLES))) $(DIALECT_FILES)) \
		$(addprefix doc/edmd/,$(notdir $(PAPERS))) > edmd/installed
	$(Q)install -d $(BELOW)/$(BASH_COMPLETION) \
		$(BELOW)/$(ZSH_COMPLETION)
	$(Q)for p in $(PROGRAMS); do n=$$(basename $$p); \
		packaging/completion bash $$p > $(BELOW)/$(BASH_COMPLETION)/$$n && \
		packaging/completion zsh $$p > $(BELOW)/$(ZSH_COMPLETION)/_$$n || exit 1; done
	$(Q)install -m 644 docs/man/*.1 $(BELOW)/share/man/man1
	$(Q)install -m 644 docs/man/*.8 $(BELOW)/share/man/man8

# Debian packages, into build/deb.  They are built in a folder of their own, with
# what Debian hardens programs by, and without the name of this folder.
DEB_FLAGS = -g0 -fstack-protector-strong -D_FORTIFY_SOURCE=2 \
	    -ffile-prefix-map='$(CURDIR)'=.
DEB_B	= build-deb
DEB_MAKE = $(MAKE) --no-print-directory B=$(DEB_B) OPT="-O2 $(DEB_FLAGS)" \
	   HARDEN=-Wl,-z,relro,-z,now PREFIX=/usr \
	   DESTDIR=$(DEB_B)/deb/root
.PHONY: deb
deb:
	@tests/setup deb
	+@$(DEB_MAKE) all panel
	$(Q)rm -rf $(DEB_B)/deb
	+@$(DEB_MAKE) install
	$(Q)packaging/deb $(DEB_B) $(DEB_B)/deb/root build/deb $(VERSION)

# All that install brought, but for /etc/edmd, which is the user's, and for
# what he has changed or added beside it.
uninstall:
	$(call say,REMOVE,$(DESTDIR)$(PREFIX))
	$(Q)rm -f $(PROGRAMS:$(B)/%=$(BINDIR)/%) \
		$(patsubst systemd/%.in,$(UNITDIR)/%,$(wildcard systemd/*.service.in)) \
		$(INTO)/usr/lib/sysusers.d/edmd.conf \
		$(INTO)/usr/lib/tmpfiles.d/edmd.conf \
		$(PROGRAMS:$(B)/%=$(BELOW)/$(BASH_COMPLETION)/%) \
		$(PROGRAMS:$(B)/%=$(BELOW)/$(ZSH_COMPLETION)/_%) \
		$(INTO)/usr/lib/udev/rules.d/60-edmd.rules \
		$(patsubst docs/man/%,$(BELOW)/share/man/man1/%,$(wildcard docs/man/*.1)) \
		$(patsubst docs/man/%,$(BELOW)/share/man/man8/%,$(wildcard docs/man/*.8))
	$(Q)rm -rf $(BELOW)/share/edmd/panel $(BELOW)/share/edmd/nodesets
	$(Q)cd $(BELOW)/share 2>/dev/null || exit 0; \
	LC_ALL=C sha256sum -c edmd/installed 2>/dev/null | \
		sed -n 's/: OK$$//p' | xargs rm -f edmd/installed; \
	rmdir edmd/examples edmd/dialects edmd doc/edmd 2>/dev/null; \
	find edmd doc/edmd -type f -printf '  KEPT    %H/%P: not what was installed\n' \
		2>/dev/null || true

clean:
	rm -rf build build-deb build-san build-tsan build-gpiod2 build-vm

-include $(shell find $(B) -name '*.d' -type f 2>/dev/null)

.PHONY: all hall modbus-person panel pictures-panel panel-load panel-frames panel-firefox demo bench-plan check quick vm vm-parts check-vm units run-units run-crossings clang bench \
	experiments experiments-pulse experiments-contour experiments-jump \
	experiments-curve experiments-servo experiments-wire experiments-times invariants \
	walkable wire-random \
	pictures callgraph faults plc-files fuzz lint install uninstall clean
.SECONDARY:
