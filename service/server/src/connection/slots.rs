//! Who may hold a connection: so many in all, so many from one address, and a few beside them for health.
//!
//! A connection that has said nothing yet gives its place to a newcomer when there is none left, the oldest first; so
//! connections that stay silent shut nobody out. Where all that hold a place have spoken, a newcomer gets a spare one, on
//! which only health is answered, and which the next newcomer may take.

use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

/// Places beside the others, for health.
const SPARE: usize = 8;

/// The places of a server.
#[derive(Debug)]
pub(super) struct Slots {
    all: usize,
    each: usize,
    held: Mutex<Held>,
}

#[derive(Debug, Default)]
struct Held {
    next: u64,
    count: usize,
    by_address: HashMap<IpAddr, usize>,
    /// Connections that have said nothing yet, by age, with what ends them.
    silent: BTreeMap<u64, (IpAddr, oneshot::Sender<()>)>,
    /// Spare ones, by age.
    spare: BTreeMap<u64, oneshot::Sender<()>>,
}

/// A place, given back when it is dropped.
#[derive(Debug)]
pub(super) struct Slot {
    slots: Arc<Slots>,
    id: u64,
    address: IpAddr,
    /// True once the connection has spoken: the place is its own.
    spoken: bool,
    /// True when only health is answered.
    pub(super) spare: bool,
}

/// Hears when a place goes to somebody else.
pub(super) type Taken = oneshot::Receiver<()>;

impl Slots {
    /// Returns so many places in all, and so many of them for one address.
    pub(super) fn new(all: usize, each: usize) -> Arc<Self> {
        Arc::new(Self { all, each, held: Mutex::default() })
    }

    /// Returns a place for a connection from an address.
    pub(super) fn take(self: &Arc<Self>, address: IpAddr) -> (Slot, Taken) {
        let mut held = self.lock();
        let (end, taken) = oneshot::channel();
        let id = held.next;
        held.next += 1;
        let own = held.by_address.get(&address).copied().unwrap_or_default();
        let full = own >= self.each || held.count >= self.all;
        // where the address has too many, one of its own goes; where the server has, any
        let evicted = full.then(|| held.oldest_silent((own >= self.each).then_some(address))).flatten();
        let spare = full && evicted.is_none();
        if let Some(evicted) = evicted {
            held.leave(evicted);
        }
        if spare {
            if held.spare.len() >= SPARE {
                held.spare.pop_first(); // its end hears that nobody holds the other one
            }
            held.spare.insert(id, end);
        } else {
            held.count += 1;
            *held.by_address.entry(address).or_default() += 1;
            held.silent.insert(id, (address, end));
        }
        drop(held);
        (Slot { slots: Arc::clone(self), id, address, spoken: false, spare }, taken)
    }

    fn lock(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Held {
    fn oldest_silent(&self, of: Option<IpAddr>) -> Option<u64> {
        self.silent.iter().find(|(_, (address, _))| of.is_none_or(|of| of == *address)).map(|(id, _)| *id)
    }

    /// Takes the place of a silent connection away and ends it.
    fn leave(&mut self, id: u64) {
        if let Some((address, _end)) = self.silent.remove(&id) {
            self.give_back(address);
        }
    }

    fn give_back(&mut self, address: IpAddr) {
        self.count -= 1;
        if let Some(own) = self.by_address.get_mut(&address) {
            *own -= 1;
            if *own == 0 {
                self.by_address.remove(&address);
            }
        }
    }
}

impl Slot {
    /// Keeps the place, now that the connection has spoken. Returns false when it is gone already.
    pub(super) fn speaks(&mut self) -> bool {
        if self.spare {
            return true;
        }
        self.spoken = self.slots.lock().silent.remove(&self.id).is_some();
        self.spoken
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        let mut held = self.slots.lock();
        if self.spare {
            held.spare.remove(&self.id);
        } else if self.spoken || held.silent.remove(&self.id).is_some() {
            held.give_back(self.address);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(n: u8) -> IpAddr {
        IpAddr::from([10, 0, 0, n])
    }

    /// Returns true when a place was given to somebody else.
    fn is_taken(taken: &mut Taken) -> bool {
        taken.try_recv() == Err(oneshot::error::TryRecvError::Closed)
    }

    #[test]
    fn silent_connections_make_room_and_spoken_ones_stay() {
        let slots = Slots::new(3, 2);
        let (first, mut first_taken) = slots.take(address(1));
        let (mut second, _taken) = slots.take(address(1));
        assert!(second.speaks());
        // the address has as many as one may: its own silent one goes
        let (mut third, _taken) = slots.take(address(1));
        assert!(is_taken(&mut first_taken) && !third.spare);
        assert!(third.speaks());
        let (spare, mut spare_taken) = slots.take(address(1));
        assert!(spare.spare && !is_taken(&mut spare_taken));
        // another address has room, and its silent one gives way when the server is full
        let (fourth, mut fourth_taken) = slots.take(address(2));
        let (mut fifth, _taken) = slots.take(address(3));
        assert!(is_taken(&mut fourth_taken) && fifth.speaks());
        // all have spoken: spare ones only, the oldest of which gives way
        let all: Vec<_> = (0..SPARE).map(|_| slots.take(address(4))).collect();
        assert!(all.iter().all(|(slot, _)| slot.spare) && is_taken(&mut spare_taken));
        drop((second, third));
        let (sixth, _taken) = slots.take(address(1));
        assert!(!sixth.spare);
        drop((first, sixth, fifth, fourth, all, spare));
        let held = slots.lock();
        assert!(held.count == 0 && held.by_address.is_empty() && held.spare.is_empty(), "{held:?}");
    }
}
