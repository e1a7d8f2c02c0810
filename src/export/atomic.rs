//! Writing a file so that it is either whole or not there.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use super::ExportError;

/// What the closure of [`write_atomically`] writes to: buffered, and able to seek.
pub type AtomicWriter<'file> = BufWriter<&'file File>;

/// Writes `path` through a temporary file in the same folder, which replaces the old file only when it is complete
/// and on the disk.
///
/// On any failure, in `write` or here, the old file stays as it was and the temporary file is removed. A symbolic
/// link is followed, so that the link itself survives; the permissions of a replaced file are kept. Only a killed
/// process can leave a file named `.nephoscope-….part` behind.
///
/// # Errors
/// Whatever `write` returns, and [`ExportError`]s for a missing or unwritable folder, a full disk, a write-protected
/// file, and a path that is no regular file.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut AtomicWriter<'_>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let replaced = replaceable(path, &target)?;
    let folder = folder_of(&target);
    if !folder.is_dir() {
        return Err(ExportError::FolderMissing { path: path.to_owned(), folder });
    }

    let temporary = temporary_in(&folder).map_err(|cause| match cause.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            ExportError::FolderNotWritable { path: path.to_owned(), folder: folder.clone(), cause }
        }
        _ => ExportError::writing(path, cause),
    })?;
    let failed = |cause| ExportError::writing(path, cause);
    {
        let mut writer = BufWriter::with_capacity(1 << 18, temporary.as_file());
        write(&mut writer)?;
        writer.flush().map_err(failed)?;
    }
    if let Some(permissions) = replaced {
        temporary.as_file().set_permissions(permissions).map_err(failed)?;
    }
    // Without this the rename could reach the disk before the contents: a power cut would leave an empty file.
    temporary.as_file().sync_all().map_err(failed)?;
    temporary.persist(&target).map_err(|error| failed(error.error))?;
    sync_folder(&folder);
    Ok(())
}

/// Permissions of the file that will be replaced, `None` if there is none; refuses what must not be replaced.
fn replaceable(path: &Path, target: &Path) -> Result<Option<fs::Permissions>, ExportError> {
    match fs::metadata(target) {
        // Renaming over /dev/null as root would replace the device by an image.
        Ok(metadata) if !metadata.is_file() => Err(ExportError::NotAFile { path: path.to_owned() }),
        Ok(metadata) if metadata.permissions().readonly() => Err(ExportError::WriteProtected { path: path.to_owned() }),
        Ok(metadata) => Ok(Some(metadata.permissions())),
        // A missing folder and the like are told apart by the caller.
        Err(_) => Ok(None),
    }
}

fn folder_of(target: &Path) -> PathBuf {
    match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A temporary file, in the folder of its target since a rename cannot cross file systems.
fn temporary_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".nephoscope-").suffix(".part");
    // Temporary files are private by default; an exported image should get what the user's umask says.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Makes the rename itself durable. A failure is no reason to complain: the file is whole and in place, and some
/// file systems cannot sync folders.
fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = folder;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn write_text(path: &Path, text: &str) -> Result<(), ExportError> {
        write_atomically(path, |writer| {
            writer.write_all(text.as_bytes()).map_err(|error| ExportError::writing(path, error))
        })
    }

    #[test]
    fn writes_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.txt");
        write_text(&path, "first").unwrap();
        write_text(&path, "second").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(names_in(folder.path()), ["sky.txt"], "no temporary file may remain");
    }

    #[test]
    fn a_failing_writer_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.txt");
        write_text(&path, "old").unwrap();
        let result = write_atomically(&path, |writer| {
            writer.write_all(b"half a new fi").map_err(|error| ExportError::writing(&path, error))?;
            Err(ExportError::Encode { path: path.clone(), reason: "gave up".into() })
        });
        assert!(matches!(result, Err(ExportError::Encode { .. })), "{result:?}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names_in(folder.path()), ["sky.txt"], "no temporary file may remain");
    }

    #[test]
    fn a_panicking_writer_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.txt");
        write_text(&path, "old").unwrap();
        let outcome = std::panic::catch_unwind(|| write_atomically(&path, |_| panic!("a bug in an encoder")));
        assert!(outcome.is_err(), "the panic must come through");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names_in(folder.path()), ["sky.txt"], "no temporary file may remain");
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_text(&folder.path().join("no/such/sky.txt"), "x").unwrap_err();
        assert!(matches!(error, ExportError::FolderMissing { .. }), "{error:?}");
        assert!(error.to_string().contains("create it"), "the remedy belongs in the message: {error}");
    }

    #[test]
    fn folders_and_devices_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(write_text(folder.path(), "x"), Err(ExportError::NotAFile { .. })));
        #[cfg(unix)]
        assert!(matches!(write_text(Path::new("/dev/null"), "x"), Err(ExportError::NotAFile { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn a_protected_file_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.txt");
        write_text(&path, "old").unwrap();
        fs::set_permissions(&path, std::os::unix::fs::PermissionsExt::from_mode(0o444)).unwrap();
        assert!(matches!(write_text(&path, "new"), Err(ExportError::WriteProtected { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    }

    #[cfg(unix)]
    #[test]
    fn an_unwritable_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        fs::set_permissions(folder.path(), std::os::unix::fs::PermissionsExt::from_mode(0o555)).unwrap();
        if tempfile::tempfile_in(folder.path()).is_ok() {
            return; // Permission bits do not bind the superuser.
        }
        let error = write_text(&folder.path().join("sky.txt"), "x").unwrap_err();
        assert!(matches!(error, ExportError::FolderNotWritable { .. }), "{error:?}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_recognised_and_harmless() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.txt");
        write_text(&path, "old").unwrap();
        let error = write_atomically(&path, |_| {
            let mut full = File::options().write(true).open("/dev/full").unwrap();
            full.write_all(b"x").map_err(|error| ExportError::writing(&path, error))
        })
        .unwrap_err();
        assert!(matches!(error, ExportError::DiskFull { .. }), "{error:?}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_survive() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("sky.txt"), folder.path().join("latest.txt"));
        write_text(&file, "old").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_text(&link, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink(), "the link must stay a link");
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
    }
}
