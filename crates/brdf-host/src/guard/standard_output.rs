//! Keeps standard output for data: the output of plugins goes elsewhere.
//!
//! After redirection, descriptor 1, to which plugins print, is standard error. Data goes through a
//! private descriptor, and so do the guard's messages: a plugin may close standard error.

use std::fs::File;
use std::io::{self, Write};
#[cfg(unix)]
use std::os::fd::{AsFd, BorrowedFd, IntoRawFd};
use std::sync::OnceLock;
#[cfg(unix)]
use std::sync::atomic::{AtomicI32, Ordering};

static ASIDE: OnceLock<File> = OnceLock::new();

/// Redirects standard output for [`StandardOutput`]. Does nothing on systems without descriptors,
/// and in later calls.
pub(super) fn set_aside() -> io::Result<()> {
    if ASIDE.get().is_some() {
        return Ok(());
    }
    // Buffered output belongs to the data.
    io::stdout().flush()?;
    #[cfg(unix)]
    {
        let private = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stdout(), LEAST_PRIVATE_DESCRIPTOR)?;
        match rustix::stdio::dup2_stdout(rustix::stdio::stderr()) {
            Ok(()) => {}
            // Standard error is closed.
            Err(_) => rustix::stdio::dup2_stdout(File::options().write(true).open("/dev/null")?)?,
        }
        let private = ASIDE.get_or_init(|| File::from(private));
        if let Ok(messages) = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stderr(), LEAST_PRIVATE_DESCRIPTOR) {
            MESSAGES.store(messages.into_raw_fd(), Ordering::Release);
        }
        let _ = FILES.set(identities(private));
    }
    Ok(())
}

/// The descriptor of the guard's messages, which a signal handler reads.
#[cfg(unix)]
static MESSAGES: AtomicI32 = AtomicI32::new(libc::STDERR_FILENO);

/// The descriptor of the guard's messages: a private copy of standard error after redirection.
#[cfg(unix)]
pub(super) fn messages() -> i32 {
    MESSAGES.load(Ordering::Acquire)
}

/// Device and inode of the three standard files and of the data's standard output, at redirection.
#[cfg(unix)]
static FILES: OnceLock<[Option<(u64, u64)>; 4]> = OnceLock::new();

#[cfg(unix)]
fn identities(private: &File) -> [Option<(u64, u64)>; 4] {
    let [input, output, error] = [rustix::stdio::stdin(), rustix::stdio::stdout(), rustix::stdio::stderr()];
    [input, output, error, private.as_fd()].map(identity)
}

#[cfg(unix)]
fn identity(file: BorrowedFd<'_>) -> Option<(u64, u64)> {
    // The types differ between systems.
    #[allow(clippy::unnecessary_cast)]
    rustix::fs::fstat(file).ok().map(|found| (found.st_dev as u64, found.st_ino as u64))
}

/// Whether standard input, output and error are still the same files. If a plugin closes one of
/// them, the program reads nothing, or the next file that it opens takes what is printed.
pub(super) fn is_intact() -> bool {
    #[cfg(unix)]
    if let (Some(before), Some(private)) = (FILES.get(), ASIDE.get()) {
        return *before == identities(private);
    }
    true
}

/// Smallest private descriptor, above those that programs commonly use.
#[cfg(unix)]
const LEAST_PRIVATE_DESCRIPTOR: i32 = 20;

/// The program's standard output, wherever it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct StandardOutput;

/// The program's standard output, for a process that it starts.
#[must_use]
pub fn for_child() -> std::process::Stdio {
    ASIDE.get().and_then(|file| file.try_clone().ok()).map_or_else(std::process::Stdio::inherit, Into::into)
}

/// Whether the program was started without a standard output. The standard library opens the null
/// device in its place before `main`, which would discard all output.
#[cfg(any(target_os = "linux", target_vendor = "apple"))]
mod at_start {
    use std::io;
    use std::sync::atomic::{AtomicBool, Ordering};

    static WAS_CLOSED: AtomicBool = AtomicBool::new(false);

    extern "C" fn inspect() {
        // SAFETY: has no conditions; it runs before the standard library is ready, and uses none of
        // it.
        let flags = unsafe { libc::fcntl(libc::STDOUT_FILENO, libc::F_GETFD) };
        WAS_CLOSED.store(flags == -1, Ordering::Relaxed);
    }

    // SAFETY: the functions of this section are called once at the start, without arguments that
    // this one reads.
    #[used]
    #[cfg_attr(target_os = "linux", unsafe(link_section = ".init_array"))]
    #[cfg_attr(target_vendor = "apple", unsafe(link_section = "__DATA,__mod_init_func"))]
    static INSPECT: extern "C" fn() = inspect;

    pub(super) fn check() -> io::Result<()> {
        match WAS_CLOSED.load(Ordering::Relaxed) {
            true => Err(io::Error::new(io::ErrorKind::NotConnected, "it was closed when the program started")),
            false => Ok(()),
        }
    }
}

#[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
mod at_start {
    pub(super) fn check() -> std::io::Result<()> {
        Ok(())
    }
}

impl Write for StandardOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        at_start::check()?;
        match ASIDE.get() {
            Some(mut file) => file.write(bytes),
            None => io::stdout().write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match ASIDE.get() {
            Some(mut file) => file.flush(),
            None => io::stdout().flush(),
        }
    }
}
