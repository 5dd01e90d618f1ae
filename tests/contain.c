/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contain.c - run a command with the rights of an ordinary container's root
 *
 *	contain COMMAND ...
 *
 * What is left are the capabilities of container engines by default, and of
 * system calls those that their filter lets through without further
 * capabilities: no namespaces, no mounts, no keys, no other personality.  It
 * stands for such an engine where none runs, and is no protection.
 */
#include <errno.h>
#include <linux/audit.h>
#include <linux/capability.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#define LEN(a)	(sizeof(a) / sizeof((a)[0]))

static const int kept[] = {
	CAP_CHOWN, CAP_DAC_OVERRIDE, CAP_FOWNER, CAP_FSETID, CAP_KILL,
	CAP_SETGID, CAP_SETUID, CAP_SETPCAP, CAP_NET_BIND_SERVICE,
	CAP_NET_RAW, CAP_SYS_CHROOT, CAP_MKNOD, CAP_AUDIT_WRITE, CAP_SETFCAP,
};

static const unsigned int refused[] = {
	SYS_unshare, SYS_setns, SYS_mount, SYS_umount2, SYS_pivot_root,
	SYS_mount_setattr, SYS_move_mount, SYS_open_tree, SYS_fsopen,
	SYS_fsmount, SYS_fsconfig, SYS_fspick, SYS_add_key, SYS_request_key,
	SYS_keyctl, SYS_bpf, SYS_perf_event_open, SYS_userfaultfd,
	SYS_io_uring_setup, SYS_io_uring_enter, SYS_io_uring_register,
	SYS_kexec_load, SYS_init_module, SYS_finit_module, SYS_delete_module,
	SYS_open_by_handle_at, SYS_fanotify_init, SYS_quotactl, SYS_acct,
	SYS_swapon, SYS_swapoff, SYS_reboot, SYS_syslog, SYS_sethostname,
	SYS_setdomainname, SYS_clock_settime, SYS_settimeofday,
	SYS_clock_adjtime, SYS_adjtimex, SYS_mbind, SYS_set_mempolicy,
	SYS_get_mempolicy, SYS_move_pages, SYS_migrate_pages, SYS_vhangup,
};

#define STMT(code, k)		BPF_STMT(code, k)
#define LOAD(field) \
	STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, field))
#define RET(k)			STMT(BPF_RET | BPF_K, k)
#define NO			RET(SECCOMP_RET_ERRNO | EPERM)
#define EQUAL(k, yes, no)	BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, k, yes, no)
#define ANY_BIT(k, yes, no)	BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, k, yes, no)

#define NEW_ANY	(CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | \
		 CLONE_NEWIPC | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET)

static const struct sock_filter head[] = {
	LOAD(nr),
	/* Its flags are in memory, where no filter can look. */
	EQUAL(SYS_clone3, 0, 1),
	RET(SECCOMP_RET_ERRNO | ENOSYS),
	EQUAL(SYS_clone, 0, 4),
	LOAD(args[0]),
	ANY_BIT(NEW_ANY, 0, 1),
	NO,
	RET(SECCOMP_RET_ALLOW),
	/* The one of Linux, with or without its 3 GB; or a question. */
	EQUAL(SYS_personality, 0, 7),
	LOAD(args[0]),
	EQUAL(0xffffffffu, 4, 0),
	EQUAL(0, 3, 0),
	EQUAL(8, 2, 0),
	EQUAL(0x20000, 1, 0),
	NO,
	RET(SECCOMP_RET_ALLOW),
};

static int filter(void)
{
	struct sock_filter code[LEN(head) + 2 * LEN(refused) + 1];
	struct sock_fprog prog = { .len = LEN(code), .filter = code };
	size_t n = 0;

	for (size_t i = 0; i < LEN(head); i++)
		code[n++] = head[i];
	for (size_t i = 0; i < LEN(refused); i++) {
		code[n++] = (struct sock_filter)EQUAL(refused[i], 0, 1);
		code[n++] = (struct sock_filter)NO;
	}
	code[n++] = (struct sock_filter)RET(SECCOMP_RET_ALLOW);
	return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &prog);
}

static int keeps(int cap)
{
	for (size_t i = 0; i < LEN(kept); i++)
		if (kept[i] == cap)
			return 1;
	return 0;
}

static int drop(void)
{
	struct __user_cap_header_struct h = { _LINUX_CAPABILITY_VERSION_3, 0 };
	struct __user_cap_data_struct d[2] = { { 0 } };

	for (int cap = 0; prctl(PR_CAPBSET_READ, cap) >= 0; cap++)
		if (!keeps(cap) && prctl(PR_CAPBSET_DROP, cap) < 0)
			return -1;
	for (size_t i = 0; i < LEN(kept); i++)
		d[kept[i] / 32].permitted |= 1u << kept[i] % 32;
	d[0].effective = d[0].permitted;
	d[1].effective = d[1].permitted;
	return (int)syscall(SYS_capset, &h, d);
}

int main(int argc, char **argv)
{
	if (argc < 2) {
		fprintf(stderr, "usage: contain COMMAND ...\n");
		return 64;
	}
	/* The filter needs a right that goes, so it comes first. */
	if (filter() < 0 || drop() < 0) {
		perror("contain");
		return 71;
	}
	execvp(argv[1], argv + 1);
	perror(argv[1]);
	return 127;
}
