//! One writer per folder of results.
//!
//! The lock is one of the operating system on `ensemble.lock`: that of a killed program is gone with it, whatever is left
//! of the file.

use crate::store::StoreError;
use fs4::{FileExt, TryLockError};
use std::fs::{File, OpenOptions};
use std::path::Path;

/// Keeps other writers out of a folder until it is dropped.
#[derive(Debug)]
pub struct FolderLock {
    /// Open: closing it unlocks.
    _file: File,
}

impl FolderLock {
    /// Locks a folder, which is made where it is not.
    ///
    /// # Errors
    /// Another one writes into it; no folder can be made there.
    pub fn take(folder: &Path) -> Result<Self, StoreError> {
        let failed = |path: &Path, source| StoreError::File { path: path.to_owned(), source };
        std::fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
        let path = folder.join("ensemble.lock");
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        let file = file.map_err(|error| failed(&path, error))?;
        match FileExt::try_lock(&file) {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::WouldBlock) => Err(StoreError::Busy { folder: folder.to_owned() }),
            Err(TryLockError::Error(error)) => Err(failed(&path, error)),
        }
    }
}
