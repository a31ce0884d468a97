use super::stale::Owner;
use super::*;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, SystemTime};
use tempfile::TempDir;

const BYTES: usize = 1 << 18;
/// Tells the test below that it is a process of its own, and what to write where.
const CHILD: &str = "PERILUNE_TEST_WRITES";

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Writes `path` over and over, all bytes `letter`, in a process of its own.
fn writer(path: &Path, letter: char, count: usize) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "files::tests::process_that_writes", "--nocapture"])
        .env(CHILD, format!("{letter} {count} {}", path.display()))
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn process_that_writes() {
    let Ok(task) = std::env::var(CHILD) else { return };
    let [letter, count, path] = task.splitn(3, ' ').collect::<Vec<_>>().try_into().unwrap();
    let bytes = vec![letter.as_bytes()[0]; BYTES];
    for _ in 0..count.parse::<usize>().unwrap() {
        write(Path::new(path), &bytes).unwrap();
    }
}

fn assert_whole(path: &Path) {
    let bytes = fs::read(path).unwrap();
    assert!(bytes.len() == BYTES && bytes.iter().all(|byte| *byte == bytes[0]), "{} bytes", bytes.len());
}

#[test]
fn processes_and_threads_that_write_one_name_never_mix() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("file");
    write(&path, &[b'o'; BYTES]).unwrap();
    let mut processes = [writer(&path, 'a', 60), writer(&path, 'b', 60)];
    std::thread::scope(|scope| {
        let path = &path;
        for letter in [b'c', b'd'] {
            scope.spawn(move || (0..60).for_each(|_| write(path, &[letter; BYTES]).unwrap()));
        }
        (0..200).for_each(|_| assert_whole(path));
    });
    assert!(processes.iter_mut().all(|process| process.wait().unwrap().success()));
    assert_whole(&path);
    assert_eq!(names(folder.path()), ["file"]);
}

/// Killed at ten moments: the file is an old one or a new one, and what is left is swept away.
#[test]
#[cfg(unix)]
fn a_killed_process_leaves_a_whole_file() {
    use std::os::unix::process::ExitStatusExt;

    let folder = TempDir::new().unwrap();
    let path = folder.path().join("file");
    write(&path, &[b'o'; BYTES]).unwrap();
    for moment in 0..10 {
        let mut process = writer(&path, 'n', usize::MAX);
        std::thread::sleep(Duration::from_millis(20 + 7 * moment));
        process.kill().unwrap();
        // One that had ended by itself would prove nothing.
        assert_eq!(process.wait().unwrap().signal(), Some(9));
        assert_whole(&path);
        remove_stale(folder.path()).unwrap();
        assert_eq!(names(folder.path()), ["file"]);
    }
}

#[test]
fn a_file_dropped_before_its_end_leaves_the_old_one() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("file");
    write(&path, b"old").unwrap();
    let mut file = NewFile::create(&path).unwrap();
    file.write_all(b"ne").unwrap();
    assert_eq!(names(folder.path()).len(), 2);
    drop(file);
    assert_eq!(names(folder.path()), ["file"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");
}

#[test]
fn a_failed_rename_leaves_nothing() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("file");
    fs::create_dir_all(path.join("inside")).unwrap();
    write(&path, b"bytes").unwrap_err();
    let (name, error) = write_in_order(folder.path(), [("first", b"1".as_slice()), ("file", b"2")]).unwrap_err();
    assert_eq!(name, path, "{error}");
    assert_eq!(names(folder.path()), ["file", "first"]);
}

/// `/dev/full` answers every write with ENOSPC.
#[test]
#[cfg(target_os = "linux")]
fn a_device_is_written_to_as_it_is() {
    write(Path::new("/dev/null"), b"bytes").unwrap();
    assert_eq!(write(Path::new("/dev/full"), b"bytes").unwrap_err().kind(), io::ErrorKind::StorageFull);
}

#[test]
fn a_committed_file_can_be_read_through_its_handle() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("file");
    let mut file = NewFile::create(&path).unwrap();
    file.write_all(b"mine").unwrap();
    let mut mine = file.commit().unwrap();
    write(&path, b"other").unwrap();
    let mut text = String::new();
    mine.seek(SeekFrom::Start(0)).unwrap();
    io::Read::read_to_string(&mut mine, &mut text).unwrap();
    assert_eq!(text, "mine");
}

#[test]
fn only_temporaries_of_processes_that_are_gone_are_removed() {
    let folder = TempDir::new().unwrap();
    let mut process =
        Command::new(std::env::current_exe().unwrap()).arg("--list").stdout(Stdio::null()).spawn().unwrap();
    process.wait().unwrap();
    let (gone, host) = (process.id(), host());
    let stale = format!(".file.{host}-{gone}-0123456789abcdef.partial");
    let old = ".file.elsewhere-1-0123456789abcdef.partial".to_string();
    let locked = format!(".locked.{host}-{gone}-0123456789abcdef.partial");
    let kept = [
        "file".to_string(),
        "file.partial".into(),
        ".file.partial".into(),
        format!(".file.{host}-{}-0123456789abcdef.partial", std::process::id()),
        format!(".file.{host}-{gone}-0123.partial"),
        ".file.elsewhere-2-0123456789abcdef.partial".into(),
        locked.clone(),
    ];
    for name in kept.iter().chain([&stale, &old]) {
        fs::write(folder.path().join(name), "").unwrap();
    }
    let long_ago = SystemTime::now() - Duration::from_secs(8 * 24 * 3600);
    File::options().write(true).open(folder.path().join(&old)).unwrap().set_modified(long_ago).unwrap();
    let held = File::open(folder.path().join(&locked)).unwrap();
    held.try_lock().unwrap();
    let mut living = NewFile::create(&folder.path().join("living")).unwrap();
    assert_eq!(remove_stale(folder.path()).unwrap(), 2);
    living.write_all(b"on").unwrap();
    living.commit().unwrap();
    let mut expected: Vec<String> = kept.into_iter().chain(["living".into()]).collect();
    expected.sort();
    assert_eq!(names(folder.path()), expected);
}

#[test]
fn a_temporary_name_tells_its_owner() {
    let long = "x".repeat(240);
    for name in ["tile.tif", "ein Bild.é.png", long.as_str()] {
        let temporary = beside(&Path::new("folder").join(name)).unwrap();
        assert_eq!(temporary.parent(), Some(Path::new("folder")));
        let temporary = temporary.file_name().unwrap().to_str().unwrap();
        assert!(temporary.len() < 250);
        assert_eq!(Owner::of(temporary), Some(Owner { host: host(), process: std::process::id() }), "{temporary}");
    }
    assert!(beside(Path::new("..")).is_err());
}
