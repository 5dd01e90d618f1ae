# SPDX-License-Identifier: Apache-2.0
"""edm-hall-keys: what DDS Security needs for a hall of machines.

It makes an authority of the hall, and for each machine and each office (a
dispatcher, a sink, a gateway) a folder to copy to its host: an identity, and
what it may write and read.  docs/fleet.md says how it is used.
"""

from __future__ import annotations

import argparse
import datetime
import importlib
import os
import re
import shutil
import sys
from pathlib import Path
from typing import Any

# As machines have them; an authority's files have a dot.
NAME = re.compile(r"[A-Za-z0-9_-]{1,31}\Z")
HOLDS = ("ca.pem", "identity.pem", "identity.key", "governance.p7s",
         "permissions.p7s", "dds.xml")
STATES = ("EDM_MachineState", "EDM_JobReport", "EDM_Alarm", "EDM_Scope")
HEAD = ('<?xml version="1.0" encoding="UTF-8"?>\n<dds xmlns:xsi='
        '"http://www.w3.org/2001/XMLSchema-instance" '
        'xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/'
        '20170901/omg_shared_ca_{}.xsd">\n')
ALL_DOMAINS = ("<domains><id_range><min>0</min><max>230</max></id_range>"
               "</domains>")
# Nobody takes part whom the authority does not know; all is encrypted.
GOVERNANCE = HEAD.format("governance") + f"""<domain_access_rules><domain_rule>
{ALL_DOMAINS}
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>NONE</rtps_protection_kind>
<topic_access_rules><topic_rule><topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>ENCRYPT</metadata_protection_kind>
<data_protection_kind>ENCRYPT</data_protection_kind>
</topic_rule></topic_access_rules></domain_rule></domain_access_rules></dds>
"""
LIBRARY = ('<Library path="{0}/libdds_security_{1}.so" '
           'initFunction="init_{2}" finalizeFunction="finalize_{2}"/>')


class Wrong(Exception):
    """It cannot be made; says what would be accepted."""


def _topics(names: tuple[str, ...], partition: str) -> str:
    inner = "".join(f"<topic>{n}</topic>" for n in names)
    return (f"<topics>{inner}</topics><partitions>"
            f"<partition>{partition}</partition></partitions>")


def permissions(name: str, office: bool, begin: datetime.datetime,
                end: datetime.datetime) -> str:
    """A machine tells its state and answers; an office reads, and offers."""
    own = "*" if office else name
    offers, answers = ("EDM_JobOffer",), ("EDM_JobAnswer",)
    mine: tuple[str, ...] = offers if office else answers + STATES
    theirs = answers if office else offers
    rules = [f"<publish>{_topics(mine, own)}</publish>",
             f"<subscribe>{_topics(theirs, own)}</subscribe>",
             f"<subscribe>{_topics(STATES, '*')}</subscribe>"]
    span = "".join(f"<not_{k}>{t:%Y-%m-%dT%H:%M:%S}</not_{k}>"
                   for k, t in (("before", begin), ("after", end)))
    return HEAD.format("permissions") + f"""<permissions><grant name="{name}">
<subject_name>CN={name}</subject_name><validity>{span}</validity>
<allow_rule>{ALL_DOMAINS}
{"".join(sorted(rules))}
</allow_rule><default>DENY</default></grant></permissions></dds>
"""


def settings(at: str, plugins: str) -> str:
    """What CYCLONEDDS_URI is to name."""
    def file(name: str) -> str:
        return f"file:{at}/{name}"

    return f"""<CycloneDDS><Domain Id="any"><Security>
<Authentication>{LIBRARY.format(plugins, "auth", "authentication")}
<IdentityCertificate>{file("identity.pem")}</IdentityCertificate>
<IdentityCA>{file("ca.pem")}</IdentityCA>
<PrivateKey>{file("identity.key")}</PrivateKey></Authentication>
<AccessControl>{LIBRARY.format(plugins, "ac", "access_control")}
<Governance>{file("governance.p7s")}</Governance>
<PermissionsCA>{file("ca.pem")}</PermissionsCA>
<Permissions>{file("permissions.p7s")}</Permissions></AccessControl>
<Cryptographic>{LIBRARY.format(plugins, "crypto", "crypto")}</Cryptographic>
</Security></Domain></CycloneDDS>
"""


class Authority:
    """Of one hall: who it signs is known to all that have its certificate."""

    def __init__(self, folder: Path, years: float) -> None:
        try:
            self.x509: Any = importlib.import_module("cryptography.x509")
            part = "cryptography.hazmat.primitives."
            self.hashes: Any = importlib.import_module(part + "hashes")
            self.ec: Any = importlib.import_module(part + "asymmetric.ec")
            self.forms: Any = importlib.import_module(part + "serialization")
            self.pkcs7: Any = importlib.import_module(
                part + "serialization.pkcs7")
        except ImportError:
            raise Wrong("needs cryptography; apt install python3-cryptography"
                        ) from None
        self.begin = (datetime.datetime.now(datetime.timezone.utc)
                      - datetime.timedelta(days=1)).replace(microsecond=0)
        self.end = self.begin + datetime.timedelta(days=365.25 * years)
        self.folder = folder
        key, pem = folder / "ca.key", folder / "ca.pem"
        self.certificate: Any = None
        try:
            if not key.exists() and not pem.exists():
                folder.mkdir(parents=True, exist_ok=True)
                self.write_key(key, self._new_key())
            self.key = self.forms.load_pem_private_key(key.read_bytes(), None)
            if not pem.exists():
                self.write(pem, self._pem(self._signed(
                    self._name("edm hall"), self.key.public_key(), True)))
            self.certificate = self.x509.load_pem_x509_certificate(
                pem.read_bytes())
        except (OSError, ValueError) as e:
            raise Wrong(f"{key}, {pem}: {e}; both as this made them") from None
        # Who is signed is good for no longer than who signs.
        c = self.certificate
        until = (getattr(c, "not_valid_after_utc", None) or
                 c.not_valid_after.replace(tzinfo=datetime.timezone.utc))
        if until <= datetime.datetime.now(datetime.timezone.utc):
            raise Wrong(f"{pem} ended on {until:%Y-%m-%d}; a new hall in "
                        "another folder, for all its machines")
        self.end = min(self.end, until)

    def _new_key(self) -> Any:
        return self.ec.generate_private_key(self.ec.SECP256R1())

    def _name(self, cn: str) -> Any:
        return self.x509.Name([self.x509.NameAttribute(
            self.x509.NameOID.COMMON_NAME, cn)])

    def _signed(self, name: Any, public: Any, ca: bool) -> Any:
        issuer = self.certificate.subject if self.certificate else name
        return (self.x509.CertificateBuilder().subject_name(name)
                .issuer_name(issuer).public_key(public)
                .serial_number(self.x509.random_serial_number())
                .not_valid_before(self.begin).not_valid_after(self.end)
                .add_extension(self.x509.BasicConstraints(ca, None), True)
                .sign(self.key, self.hashes.SHA256()))

    def _pem(self, certificate: Any) -> bytes:
        pem: bytes = certificate.public_bytes(self.forms.Encoding.PEM)
        return pem

    @staticmethod
    def write(path: Path, what: bytes, mode: int = 0o644) -> None:
        """Whole, and nobody else reads a key for a moment."""
        new = path.with_name(path.name + ".new")
        new.unlink(missing_ok=True)
        fd = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
        with os.fdopen(fd, "wb") as f:
            f.write(what)
        new.replace(path)

    def write_key(self, path: Path, key: Any) -> None:
        """That of an identity."""
        self.write(path, key.private_bytes(
            self.forms.Encoding.PEM, self.forms.PrivateFormat.PKCS8,
            self.forms.NoEncryption()), 0o600)

    def _vouched(self, text: str) -> bytes:
        """S/MIME, as DDS Security wants it."""
        p: bytes = (self.pkcs7.PKCS7SignatureBuilder().set_data(text.encode())
                    .add_signer(self.certificate, self.key,
                                self.hashes.SHA256())
                    .sign(self.forms.Encoding.SMIME, [
                        self.pkcs7.PKCS7Options.Text,
                        self.pkcs7.PKCS7Options.DetachedSignature]))
        return p

    def identity(self, name: str, office: bool, o: argparse.Namespace) -> Path:
        """The folder for a host, whole or not at all."""
        folder, new, old = (self.folder / n for n in (
            name, f".{name}.new", f".{name}.old"))
        for left in (new, old):
            shutil.rmtree(left, ignore_errors=True)
        new.mkdir()
        key = self._new_key()
        self.write_key(new / "identity.key", key)
        for file, what in (
                ("ca.pem", self._pem(self.certificate)),
                ("identity.pem", self._pem(self._signed(
                    self._name(name), key.public_key(), False))),
                ("governance.p7s", self._vouched(GOVERNANCE)),
                ("permissions.p7s", self._vouched(permissions(
                    name, office, self.begin, self.end))),
                ("dds.xml", settings(o.at or str(folder.resolve()),
                                     o.plugins).encode())):
            self.write(new / file, what)
        if folder.exists():
            folder.rename(old)
        new.rename(folder)
        shutil.rmtree(old, ignore_errors=True)
        return folder


def plugins_here() -> str:
    """Where Debian has them.  Raises Wrong."""
    found = sorted(Path("/usr/lib").glob("*/*/libdds_security_auth.so"))
    if not found:
        raise Wrong("Cyclone DDS has no plugins for security here; apt "
                    "install libddsc0debian, or --plugins FOLDER of the hosts")
    return str(found[0].parent)


def options() -> argparse.Namespace:
    """Of the command line.  Raises Wrong."""
    p = argparse.ArgumentParser(prog="edm-hall-keys", description=__doc__)
    p.add_argument("folder", type=Path, help="of the hall; keep it safe: who "
                   "has it lets anybody in")
    p.add_argument("--machine", action="append", default=[], metavar="NAME",
                   help="[machine] name; may be given again")
    p.add_argument("--office", action="append", default=[], metavar="NAME",
                   help="edm-fleet, edm-gateway: reads, and offers jobs")
    p.add_argument("--at", metavar="FOLDER", help="where the files will be on "
                   "the host, as /etc/edmd/dds (where they are made)")
    p.add_argument("--plugins", metavar="FOLDER", help="of Cyclone DDS on the "
                   "hosts (as here)")
    p.add_argument("--years", type=float, default=10.0,
                   help="they are good (%(default)g)")
    p.add_argument("--renew", action="store_true")
    o = p.parse_args()
    names = o.machine + o.office
    if not names:
        raise Wrong("nobody is named; --machine NAME, --office NAME")
    for n in names:
        if not NAME.match(n) or names.count(n) > 1:
            raise Wrong(f"'{n}': each name once, of letters, digits and _ -, "
                        "at most 31")
        if (o.folder / n).exists() and not o.renew:
            raise Wrong(f"{o.folder / n} is there; --renew makes a new one, "
                        "and the old one stays good until it ends")
    if not 0 < o.years <= 100:
        raise Wrong(f"--years {o.years:g}: more than 0, at most 100")
    o.plugins = o.plugins or plugins_here()
    return o


def main() -> int:
    """Return: as sysexits.h."""
    try:
        o = options()
        a = Authority(o.folder, o.years)
        for n in o.machine + o.office:
            print(f"{a.identity(n, n in o.office, o)}: good until "
                  f"{a.end:%Y-%m-%d}")
    except Wrong as e:
        print(f"edm-hall-keys: {e}", file=sys.stderr)
        return 64
    except OSError as e:
        print(f"edm-hall-keys: {e.filename}: {e.strerror}", file=sys.stderr)
        return 73
    return 0


if __name__ == "__main__":
    sys.exit(main())
