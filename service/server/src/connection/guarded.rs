//! A TCP connection that must speak soon, take what it is sent, and give its place away when it is told to.

use std::future::Future;
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::{Instant, Sleep};

use super::slots::{Slot, Taken};

/// Longest time until a connection has said what it speaks.
const FIRST: Duration = Duration::from_secs(10);
/// Bytes that say it: as many as HTTP/2 begins with; no request of HTTP/1.1 to a host has fewer.
const FIRST_BYTES: usize = 24;
/// Longest time for which a client takes nothing of what waits for it.
const STALL: Duration = Duration::from_secs(60);

/// A connection with its place.
pub(super) struct Guarded {
    stream: TcpStream,
    slot: Slot,
    taken: Taken,
    /// Bytes read while it has not spoken yet; none once it has.
    silent: Option<usize>,
    /// When it must have spoken.
    first: Pin<Box<Sleep>>,
    /// When it must have taken something; none while nothing waits.
    stalled: Option<Pin<Box<Sleep>>>,
}

impl Guarded {
    pub(super) fn new(stream: TcpStream, (slot, taken): (Slot, Taken)) -> Self {
        let first = Box::pin(tokio::time::sleep(FIRST));
        Self { stream, slot, taken, silent: Some(0), first, stalled: None }
    }

    /// Returns true when only health is answered.
    pub(super) fn is_spare(&self) -> bool {
        self.slot.spare
    }

    /// Returns an error once the place is somebody else's, or the first bytes take too long.
    fn check(&mut self, cx: &mut Context<'_>) -> io::Result<()> {
        if self.silent.is_none() && !self.slot.spare {
            return Ok(());
        }
        if Pin::new(&mut self.taken).poll(cx).is_ready() {
            return Err(io::Error::new(io::ErrorKind::ConnectionAborted, "another connection has its place"));
        }
        if self.silent.is_some() && self.first.as_mut().poll(cx).is_ready() {
            return Err(io::Error::new(io::ErrorKind::TimedOut, "the client said nothing"));
        }
        Ok(())
    }

    /// Notes what was read.
    fn heard(&mut self, bytes: usize) -> io::Result<()> {
        let Some(before) = self.silent else { return Ok(()) };
        if before + bytes < FIRST_BYTES {
            self.silent = Some(before + bytes);
            return Ok(());
        }
        self.silent = None;
        match self.slot.speaks() {
            true => Ok(()),
            false => Err(io::ErrorKind::ConnectionAborted.into()),
        }
    }

    /// Returns what a write came to; an error when the client has taken nothing for too long.
    fn wrote<T>(&mut self, cx: &mut Context<'_>, written: Poll<io::Result<T>>) -> Poll<io::Result<T>> {
        if written.is_ready() {
            self.stalled = None;
            return written;
        }
        let stalled = self.stalled.get_or_insert_with(|| Box::pin(tokio::time::sleep_until(Instant::now() + STALL)));
        match stalled.as_mut().poll(cx) {
            Poll::Ready(()) => Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, "the client takes nothing"))),
            Poll::Pending => Poll::Pending,
        }
    }
}

impl AsyncRead for Guarded {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        self.check(cx)?;
        let before = buf.filled().len();
        let read = Pin::new(&mut self.stream).poll_read(cx, buf);
        if let Poll::Ready(Ok(())) = read {
            self.heard(buf.filled().len() - before)?;
        }
        read
    }
}

impl AsyncWrite for Guarded {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(cx, bytes);
        self.wrote(cx, written)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(cx, bytes);
        self.wrote(cx, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }
}
