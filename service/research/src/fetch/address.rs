//! Which internet addresses are public. All others are refused: a document's address comes from outside, and must not lead
//! to this machine, its network, or the services of a cloud that trust whoever reaches them.
//!
//! What it is not for: resolving names (`resolve`) and connecting (`exchange`).

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};
use std::str::FromStr;

/// A block of addresses, written `10.0.0.0/8` or `fc00::/7`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Network {
    base: IpAddr,
    bits: u8,
}

impl Network {
    /// Tells whether an address is in the block. An IPv4 address is never in an IPv6 block.
    pub fn contains(&self, address: IpAddr) -> bool {
        match (self.base, address) {
            (IpAddr::V4(base), IpAddr::V4(a)) => shifted(base.to_bits().into(), a.to_bits().into(), 32, self.bits),
            (IpAddr::V6(base), IpAddr::V6(a)) => shifted(base.to_bits(), a.to_bits(), 128, self.bits),
            _ => false,
        }
    }
}

fn shifted(a: u128, b: u128, width: u8, bits: u8) -> bool {
    let shift = u32::from(width.saturating_sub(bits));
    a.checked_shr(shift).unwrap_or(0) == b.checked_shr(shift).unwrap_or(0)
}

impl FromStr for Network {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?} is no block of addresses like 10.0.0.0/8");
        let (base, bits) = text.split_once('/').ok_or_else(wrong)?;
        let (base, bits): (IpAddr, u8) = (base.parse().map_err(|_| wrong())?, bits.parse().map_err(|_| wrong())?);
        let width = if base.is_ipv4() { 32 } else { 128 };
        if bits > width { Err(wrong()) } else { Ok(Self { base, bits }) }
    }
}

/// IPv4 blocks that are not public, with their names (IANA's register of special-purpose addresses).
const REFUSED_V4: &[(u32, u8, &str)] = &[
    (0x0000_0000, 8, "an address of this network"),
    (0x0a00_0000, 8, "a private address"),
    (0x6440_0000, 10, "an address of a carrier's own network"),
    (0x7f00_0000, 8, "a loopback address"),
    (0xa9fe_0000, 16, "a link-local address"),
    (0xac10_0000, 12, "a private address"),
    (0xc000_0000, 24, "a reserved address"),
    (0xc000_0200, 24, "an address for documentation"),
    (0xc01f_c400, 24, "a reserved address"),
    (0xc034_c100, 24, "a reserved address"),
    (0xc058_6300, 24, "a reserved address"),
    (0xc0a8_0000, 16, "a private address"),
    (0xc0af_3000, 24, "a reserved address"),
    (0xc612_0000, 15, "an address for benchmarks"),
    (0xc633_6400, 24, "an address for documentation"),
    (0xcb00_7100, 24, "an address for documentation"),
    (0xe000_0000, 4, "a multicast address"),
    (0xf000_0000, 4, "a reserved address"),
];

/// IPv6 blocks inside the global ones that are not public.
const REFUSED_V6: &[(u128, u8, &str)] = &[
    (0x2001_0000 << 96, 23, "an address of a protocol, such as a Teredo tunnel"),
    (0x2001_0db8 << 96, 32, "an address for documentation"),
    (0x2002_0000 << 96, 16, "an address of a 6to4 tunnel"),
    (0x2620_004f_8000 << 80, 48, "a reserved address"),
    (0x3fff_0000 << 96, 20, "an address for documentation"),
];

/// IPv6 blocks outside the global ones whose names help to understand a refusal.
const NAMED_V6: &[(u128, u8, &str)] = &[
    (0, 128, "the unspecified address"),
    (1, 128, "a loopback address"),
    (0, 96, "an IPv4 address in an outdated IPv6 form"),
    (0x0064_ff9b_0001 << 80, 48, "an address of a local translator"),
    (0x0100 << 112, 64, "an address that discards what it gets"),
    (0xfc00 << 112, 7, "a private address"),
    (0xfe80 << 112, 10, "a link-local address"),
    (0xfec0 << 112, 10, "a private address"),
    (0xff00 << 112, 8, "a multicast address"),
];

/// The block of the public translators from IPv6 to IPv4 (NAT64); the last 32 bits are the IPv4 address.
const NAT64: u128 = 0x0064_ff9b << 96;

/// Returns what kind of address it is when it is not public, `None` when it is public.
///
/// An IPv4 address inside an IPv6 address (mapped, or behind a public translator) is judged as the IPv4 address.
pub fn refusal(address: IpAddr) -> Option<&'static str> {
    match address {
        IpAddr::V4(v4) => refusal_v4(v4),
        IpAddr::V6(v6) => refusal_v6(v6),
    }
}

fn refusal_v4(address: Ipv4Addr) -> Option<&'static str> {
    let bits = address.to_bits().into();
    REFUSED_V4.iter().find(|(base, n, _)| shifted((*base).into(), bits, 32, *n)).map(|(_, _, name)| *name)
}

fn refusal_v6(address: Ipv6Addr) -> Option<&'static str> {
    if let Some(v4) = address.to_ipv4_mapped() {
        return refusal_v4(v4);
    }
    let bits = address.to_bits();
    if shifted(NAT64, bits, 128, 96) {
        return refusal_v4(Ipv4Addr::from_bits((bits & 0xffff_ffff) as u32));
    }
    let named =
        |list: &[(u128, u8, &'static str)]| list.iter().find(|(b, n, _)| shifted(*b, bits, 128, *n)).map(|f| f.2);
    if shifted(0x2000 << 112, bits, 128, 3) {
        return named(REFUSED_V6);
    }
    Some(named(NAMED_V6).unwrap_or("an address outside the public ones"))
}
