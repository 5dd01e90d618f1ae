# SPDX-License-Identifier: Apache-2.0
#
# Sourced by the scripts that run in the guest, in the job's folder.  `env`
# there names where the programs are: BUILD, BUILD2 and LIB2 on libgpiod 2.x.
# They run from memory: while the guest waits for a file, virtual time runs away.
. ./env
T=/sys/kernel/tracing
R=/run/edmd-test
mkdir -p $R
cp $BUILD/edmd $BUILD/edmd-jobs $BUILD/edmctl *.ini *.ngc $R/
cp $BUILD2/edmd $R/edmd2
cp $LIB2/libgpiod.so.3* $R/
export LD_LIBRARY_PATH=$R
chmod 755 $R $R/*
# What they and this script call is read once, so that it is in memory too.
ldd $R/edmd $R/edmd2 $R/edmd-jobs $R/edmctl /bin/grep |
	awk '/=> \// { print $3 }' | sort -u | xargs cat \
	/bin/sh /bin/cat /bin/sleep /bin/grep /bin/rm /bin/mkdir /bin/sed > /dev/null
[ -e $T/trace ] || mount -t tracefs tracefs $T

# hold_line CHIP LINE - another program has it, until release_line
hold_line() {
	case $(gpioset --version) in
	*v1.*)	gpioset --mode=signal --background $1 $2=1 ;;
	*)	gpioset --daemonize --chip $1 $2=1 ;;
	esac
}

release_line() { kill $(pidof gpioset); }

# pull CHIP LINE up|down - what a switch does to an input
pull() { echo pull-$3 > $(chip_dir $1)/sim_gpio$2/pull; }

# level CHIP LINE - what a program drives
level() { cat $(chip_dir $1)/sim_gpio$2/value; }

chip_dir() {
	c=/sys/kernel/config/gpio-sim/$1
	echo /sys/devices/platform/$(cat $c/dev_name)/$(cat $c/bank0/chip_name)
}

# Trace events number lines from the chip's base.
base() {
	for g in /sys/class/gpio/gpiochip*; do
		[ "$(cat $g/label)" = $1 ] && cat $g/base && return
	done
}

trace_start() {	# [FILTER]
	echo mono > $T/trace_clock
	echo ${TRACE_KB:-40000} > $T/buffer_size_kb
	echo "${1:-0}" > $T/events/gpio/gpio_value/filter
	: > $T/trace
	echo 1 > $T/events/gpio/gpio_value/enable
}

# A program that is stopped at once may not have written since the trace began.
trace_has_writes() { turns 200 trace_is_long; }
trace_is_long() { [ $(grep -c gpio_value: $T/trace) -ge 20 ]; }

# "TIME LINE LEVEL THREAD" of each write, lines counted from the chip's first
trace_end() {	# CHIP FILE
	echo 0 > $T/events/gpio/gpio_value/enable
	cat $T/per_cpu/cpu*/stats | grep overrun > $R/overrun
	awk -v base=$(base $1) 'NF > 4 && $(NF - 3) == "gpio_value:" {
		sub(":", "", $(NF - 4)); sub(".*-", "", $1)
		print $(NF - 4), $(NF - 2) - base, $NF, $1 }' $T/trace > $R/trace
	cp $R/trace $2
	awk '$NF != 0 { print "trace lost", $0 }' $R/overrun
}

# turns N COMMAND ... - until it succeeds, N times at the most: turns, not
# seconds, because a turn takes as long as the host is slow.  LOOK: seconds between
# two turns; in virtual time a long wait costs nothing, and a look costs much.
turns() {
	left=$1; shift
	until "$@"; do
		left=$((left - 1))
		[ $left -gt 0 ] || return 1
		sleep ${LOOK:-0.05}
	done
}

edmd_start() {	# PROGRAM CONFIG
	$1 --config $2 2>$R/edmd.log &
	edmd=$!
	turns 200 edmd_is_up && kill -0 $edmd 2>/dev/null && return
	echo "edmd is not up:"; cat $R/edmd.log
	exit 1
}

edmd_is_up() {	# or has ended
	grep -q 'edmd: machine' $R/edmd.log || ! kill -0 $edmd 2>/dev/null
}

jobs_start() {	# CONFIG
	rm -rf $R/store; mkdir -p $R/store
	$R/edmd-jobs --config $1 --store $R/store 2>$R/jobs.log &
	jobs=$!
	turns 100 jobs_answer && return
	echo "edmd-jobs does not answer:"; cat $R/edmd.log $R/jobs.log
	exit 1
}

jobs_answer() { ctl status >/dev/null 2>&1; }

daemons_end() {	# NAME
	kill $jobs; wait $jobs
	kill $edmd; wait $edmd
	echo $? > $1.edmd-rc
	cat $R/edmd.log $R/jobs.log > $1.log
}

ctl() { $R/edmctl --machine vm "$@"; }

# status_is PATTERN - wait for it; says what it is if it does not come
status_is() {
	turns 150 status_has "$1" || { echo "no '$1'"; cat $R/status; return 1; }
}

# goes_on - reset and start it, again until it cuts
goes_on() { turns 50 goes_on_now; }

cutting='state *\(approach\|erode\)'
goes_on_now() { ctl reset; ctl start; status_has "$cutting"; }

status_has() { ctl status > $R/status 2>&1 && grep -q "$1" $R/status; }

job_traced() {	# NAME PROGRAM CONFIG JOB
	edmd_start $2 $3
	jobs_start $3
	trace_start ${5:-}
	ctl submit --wait $4 > $1.job 2>&1
	echo $? > $1.rc
	# To end a trace the kernel patches itself, and delays everyone.
	ctl status > $1.status 2>&1
	trace_end sim0 $1.trace
	daemons_end $1
}
