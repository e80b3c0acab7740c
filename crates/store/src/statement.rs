//! A statement and its connection: the same text on SQLite and on PostgreSQL, except where [`dialect`](super::dialect) has two texts for one meaning.
//!
//! The drivers are typed by their database. Here the choice is a value, made once when the store is opened; a statement
//! keeps its parameters until it knows which driver takes them.

use std::io::ErrorKind;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use futures_util::TryStreamExt;
use sqlx::postgres::{PgPool, Postgres};
use sqlx::sqlite::{Sqlite, SqlitePool};
use sqlx::{AssertSqlSafe, Either, Executor, PgConnection, SqlSafeStr, SqlStr, SqliteConnection};

use super::health::Health;
use super::rows::{Cell, Record, Row};

/// The connections of a database.
#[derive(Debug, Clone)]
pub(crate) enum Pool {
    /// A file.
    Sqlite(SqlitePool),
    /// A server.
    Postgres(PgPool, Renewal),
}

/// When connections to a server were last found to be out of date: older ones are given up before they are used again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Renewal(Arc<Mutex<Option<Instant>>>);

impl Renewal {
    /// True if a connection of this age has to be closed.
    pub(crate) fn outdates(&self, age: Duration) -> bool {
        self.lock().is_some_and(|since| age >= since.elapsed())
    }

    /// Looks at an error. True if the connection that met it is out of date: the tables have changed under the statements that it
    /// has prepared.
    fn finds<T>(&self, result: &Result<T, sqlx::Error>) -> bool {
        let outdated = result.as_ref().is_err_and(is_outdated);
        if outdated {
            *self.lock() = Some(Instant::now());
        }
        outdated
    }

    fn lock(&self) -> MutexGuard<'_, Option<Instant>> {
        self.0
            .lock()
            .expect("nothing panics while it holds this lock")
    }
}

/// "Cached plan must not change result type."
pub(crate) fn is_outdated(error: &sqlx::Error) -> bool {
    const FEATURE_NOT_SUPPORTED: &str = "0A000";
    let error = error.as_database_error();
    error.is_some_and(|error| error.code().as_deref() == Some(FEATURE_NOT_SUPPORTED))
}

impl Pool {
    pub(crate) fn dialect(&self) -> Dialect {
        match self {
            Self::Sqlite(_) => Dialect::Sqlite,
            Self::Postgres(..) => Dialect::Postgres,
        }
    }

    pub(crate) async fn acquire(&self) -> Result<Connection, sqlx::Error> {
        Ok(match self {
            Self::Sqlite(pool) => Connection::Sqlite(pool.acquire().await?, Unsaid::default()),
            Self::Postgres(pool, renewal) => {
                Connection::Postgres(in_time(pool.acquire()).await?, renewal.clone())
            }
        })
    }

    pub(crate) fn is_closed(&self) -> bool {
        match self {
            Self::Sqlite(pool) => pool.is_closed(),
            Self::Postgres(pool, _) => pool.is_closed(),
        }
    }

    /// Comes when it is closed.
    pub(crate) async fn closed(&self) {
        match self {
            Self::Sqlite(pool) => pool.close_event().await,
            Self::Postgres(pool, _) => pool.close_event().await,
        }
    }

    pub(crate) async fn close(&self) {
        match self {
            Self::Sqlite(pool) => pool.close().await,
            Self::Postgres(pool, _) => pool.close().await,
        }
    }
}

/// Which of the two texts of a statement is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dialect {
    Sqlite,
    Postgres,
}

/// A connection that is held for a while.
pub(crate) enum Connection {
    Sqlite(sqlx::pool::PoolConnection<Sqlite>, Unsaid),
    Postgres(sqlx::pool::PoolConnection<Postgres>, Renewal),
}

/// Statements that are sent to SQLite together with the next one. Its connection lives on a thread of its own, and the way there and back takes longer than
/// most statements.
#[derive(Default)]
pub(crate) struct Unsaid {
    text: String,
    values: Vec<Value>,
    /// Who wants to know why a transaction cannot begin, while that is unsaid.
    begins: Option<Arc<Health>>,
}

impl Unsaid {
    /// Puts a statement behind the others. The parameters of all of them are counted through.
    fn push(&mut self, text: &str, values: Vec<Value>) {
        if !self.text.is_empty() {
            self.text.push_str("; ");
        }
        self.text += &counted_on(text, self.values.len());
        self.values.extend(values);
    }

    /// The words and values of all of it, with `text` as the last one.
    fn with(&mut self, text: SqlStr, values: Vec<Value>) -> (SqlStr, Vec<Value>) {
        if self.text.is_empty() {
            return (text, values);
        }
        self.push(text.as_str(), values);
        let Self { text, values, .. } = std::mem::take(self);
        (AssertSqlSafe(text).into_sql_str(), values)
    }
}

/// A statement whose parameters are counted on behind others: with two before it, `$1` becomes `$3`.
fn counted_on(text: &str, before: usize) -> String {
    let mut parts = text.split('$');
    let mut counted = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let digits = part.bytes().take_while(u8::is_ascii_digit).count();
        let (number, rest) = part.split_at(digits);
        match number.parse::<usize>() {
            Ok(number) => counted += &format!("${}{rest}", before + number),
            Err(_) => counted.extend(["$", part]),
        }
    }
    counted
}

impl Connection {
    pub(crate) fn close_on_drop(&mut self) {
        match self {
            Self::Sqlite(connection, _) => connection.close_on_drop(),
            Self::Postgres(connection, _) => connection.close_on_drop(),
        }
    }

    /// Begins a transaction by these words. Where SQLite cannot, that shows in the next statement, and `health` gets the cause.
    pub(super) async fn begin(
        &mut self,
        words: Text,
        health: &Arc<Health>,
    ) -> Result<(), sqlx::Error> {
        if let Self::Sqlite(_, unsaid) = self {
            unsaid.begins = Some(Arc::clone(health));
        }
        self.later(query(words)).await
    }

    /// Says something that is no query.
    pub(crate) async fn say(&mut self, words: impl Into<Text>) -> Result<(), sqlx::Error> {
        let words = words.into();
        match self {
            Self::Sqlite(connection, unsaid) => {
                if let Some(words) = words.of(Dialect::Sqlite) {
                    ask(connection, unsaid, words, Vec::new()).await?;
                }
            }
            Self::Postgres(connection, _) => {
                if let Some(words) = words.of(Dialect::Postgres) {
                    in_time(sqlx::raw_sql(words).execute(&mut **connection)).await?;
                }
            }
        }
        Ok(())
    }

    /// Adds a statement without an answer. SQLite gets it with the next statement, whose result shows its errors.
    pub(crate) async fn later(&mut self, statement: Statement<Nothing>) -> Result<(), sqlx::Error> {
        match self {
            Self::Sqlite(_, unsaid) => {
                if let Some(text) = statement.text.of(Dialect::Sqlite) {
                    unsaid.push(text.as_str(), statement.values);
                }
            }
            // Several words at once, and such as have no parameters, need no statement of the driver's.
            Self::Postgres(..) if statement.values.is_empty() => self.say(statement.text).await?,
            Self::Postgres(..) => {
                statement.execute(self).await?;
            }
        }
        Ok(())
    }
}

/// A server takes so long for a statement at most, and gives it up then.
pub(super) const LONGEST_STATEMENT: Duration = Duration::from_secs(10);

/// A server that has not even said so by then is frozen, or behind a network that is.
const LONGEST_SILENCE: Duration = Duration::from_secs(12);

/// The result of `work`, if the server answers in time. A connection left in the middle of a statement is useless; the driver finds that out, and a transaction
/// closes its own.
async fn in_time<T>(work: impl Future<Output = Result<T, sqlx::Error>>) -> Result<T, sqlx::Error> {
    let done = tokio::time::timeout(LONGEST_SILENCE, work).await;
    done.unwrap_or_else(|_| {
        let silence = std::io::Error::new(ErrorKind::TimedOut, "the server does not answer");
        Err(sqlx::Error::Io(silence))
    })
}

/// The connection of a statement.
pub(crate) enum On<'c> {
    Sqlite(&'c mut SqliteConnection, &'c mut Unsaid),
    SqlitePool(&'c SqlitePool),
    Postgres(&'c mut PgConnection, &'c Renewal),
    PostgresPool(&'c PgPool, &'c Renewal),
}

impl On<'_> {
    fn dialect(&self) -> Dialect {
        match self {
            Self::Sqlite(..) | Self::SqlitePool(_) => Dialect::Sqlite,
            Self::Postgres(..) | Self::PostgresPool(..) => Dialect::Postgres,
        }
    }
}

impl<'c> From<&'c Pool> for On<'c> {
    fn from(pool: &'c Pool) -> Self {
        match pool {
            Pool::Sqlite(pool) => Self::SqlitePool(pool),
            Pool::Postgres(pool, renewal) => Self::PostgresPool(pool, renewal),
        }
    }
}

impl<'c> From<&'c mut Connection> for On<'c> {
    fn from(connection: &'c mut Connection) -> Self {
        match connection {
            Connection::Sqlite(connection, unsaid) => Self::Sqlite(connection, unsaid),
            Connection::Postgres(connection, renewal) => Self::Postgres(connection, renewal),
        }
    }
}

/// A row of which nothing is read.
pub(crate) struct Nothing;

impl Record for Nothing {
    fn read(_row: &Row) -> Result<Self, sqlx::Error> {
        Ok(Self)
    }
}

/// The text of a statement.
#[derive(Debug, Clone)]
pub(crate) enum Text {
    /// The same for both.
    Common(&'static str),
    /// One for each. Without one there is nothing to be done.
    Differing {
        sqlite: Option<&'static str>,
        postgres: Option<&'static str>,
    },
    /// Put together.
    Made(String),
}

impl From<&'static str> for Text {
    fn from(text: &'static str) -> Self {
        Self::Common(text)
    }
}

impl Text {
    fn of(self, dialect: Dialect) -> Option<SqlStr> {
        match (self, dialect) {
            (Self::Common(text), _) => Some(text.into_sql_str()),
            (Self::Differing { sqlite, .. }, Dialect::Sqlite) => {
                sqlite.map(SqlSafeStr::into_sql_str)
            }
            (Self::Differing { postgres, .. }, Dialect::Postgres) => {
                postgres.map(SqlSafeStr::into_sql_str)
            }
            // Only texts of this folder are pushed onto it; values from outside are bound.
            (Self::Made(text), _) => Some(AssertSqlSafe(text).into_sql_str()),
        }
    }
}

/// A parameter. Both databases know these kinds, and nothing else is kept.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Integer(Option<i64>),
    Text(Option<String>),
    Bytes(Vec<u8>),
}

macro_rules! value_of {
    ($($kind:ty => |$value:ident| $made:expr),* $(,)?) => {
        $(impl From<$kind> for Value {
            fn from($value: $kind) -> Self {
                $made
            }
        })*
    };
}

value_of! {
    i64 => |value| Self::Integer(Some(value)),
    u32 => |value| Self::Integer(Some(value.into())),
    Option<i64> => |value| Self::Integer(value),
    Option<u32> => |value| Self::Integer(value.map(i64::from)),
    String => |value| Self::Text(Some(value)),
    &str => |value| Self::Text(Some(value.to_owned())),
    &String => |value| Self::Text(Some(value.clone())),
    Option<&str> => |value| Self::Text(value.map(str::to_owned)),
    Option<String> => |value| Self::Text(value),
    Option<&String> => |value| Self::Text(value.cloned()),
    &Option<String> => |value| Self::Text(value.clone()),
    &[u8] => |value| Self::Bytes(value.to_owned()),
}

/// A list as a parameter.
pub(crate) fn list<T: serde::Serialize>(items: &[T]) -> String {
    serde_json::to_string(items).expect("what is listed is plain data")
}

/// A statement with its parameters.
pub(crate) struct Statement<T> {
    text: Text,
    values: Vec<Value>,
    reads: std::marker::PhantomData<fn() -> T>,
}

/// A statement of which no row is read.
pub(crate) fn query(text: impl Into<Text>) -> Statement<Nothing> {
    query_as(text)
}

/// A statement whose rows are read as `T`.
pub(crate) fn query_as<T: Record>(text: impl Into<Text>) -> Statement<T> {
    Statement {
        text: text.into(),
        values: Vec::new(),
        reads: std::marker::PhantomData,
    }
}

/// The result of a statement: rows, and the number of changed rows.
type Given = (Vec<Row>, u64);

/// Runs a statement on a connection to SQLite, after the postponed ones. Returns the result of the last one.
async fn ask(
    connection: &mut SqliteConnection,
    unsaid: &mut Unsaid,
    text: SqlStr,
    values: Vec<Value>,
) -> Result<Given, sqlx::Error> {
    let begins = unsaid.begins.take();
    let (text, values) = unsaid.with(text, values);
    let given = on_sqlite(connection, text, &values).await;
    if let (Some(health), Err(error)) = (begins, &given) {
        health.failed(error);
    }
    given
}

macro_rules! driver {
    ($name:ident, $database:ident) => {
        /// The result of the last statement of a query.
        async fn $name<'c>(
            executor: impl Executor<'c, Database = $database>,
            text: SqlStr,
            values: &[Value],
        ) -> Result<Given, sqlx::Error> {
            // A pragma acts when it is prepared: cached by the driver, it would not act the next time.
            let is_kept = !text.as_str().contains("pragma");
            let mut query = sqlx::query::<$database>(text).persistent(is_kept);
            for value in values {
                query = match value {
                    Value::Integer(value) => query.bind(*value),
                    Value::Text(value) => query.bind(value.as_deref()),
                    Value::Bytes(value) => query.bind(value.as_slice()),
                };
            }
            let mut answers = executor.fetch_many(query);
            let (mut rows, mut given) = (Vec::new(), Given::default());
            while let Some(answer) = answers.try_next().await? {
                match answer {
                    Either::Left(done) => given = (std::mem::take(&mut rows), done.rows_affected()),
                    Either::Right(row) => rows.push(Row::$database(row)),
                }
            }
            Ok(given)
        }
    };
}

driver!(on_sqlite, Sqlite);
driver!(on_postgres, Postgres);

/// Runs a statement. Where a database has no text for it, there is nothing to be done.
async fn run(on: On<'_>, text: Text, values: Vec<Value>) -> Result<Given, sqlx::Error> {
    let Some(text) = text.of(on.dialect()) else {
        return Ok(Given::default());
    };
    match on {
        On::Sqlite(connection, unsaid) => ask(connection, unsaid, text, values).await,
        On::SqlitePool(pool) => on_sqlite(pool, text, &values).await,
        On::Postgres(connection, renewal) => {
            let given = in_time(on_postgres(connection, text, &values)).await;
            // The transaction is lost with its connection; whoever tries it again gets a new one.
            renewal.finds(&given);
            given
        }
        On::PostgresPool(pool, renewal) => {
            let given = in_time(on_postgres(pool, text.clone(), &values)).await;
            if renewal.finds(&given) {
                return in_time(on_postgres(pool, text, &values)).await;
            }
            given
        }
    }
}

impl<T: Record> Statement<T> {
    /// The value of the next parameter: `$1`, then `$2`.
    pub(crate) fn bind(mut self, value: impl Into<Value>) -> Self {
        self.values.push(value.into());
        self
    }

    /// Goes on with the text of a statement that is put together.
    pub(crate) fn push(&mut self, words: &str) -> &mut Self {
        if let Text::Made(text) = &mut self.text {
            text.push_str(words);
        }
        self
    }

    /// The same with a parameter.
    pub(crate) fn push_bind(&mut self, value: impl Into<Value>) -> &mut Self {
        self.values.push(value.into());
        let parameter = format!("${}", self.values.len());
        self.push(&parameter)
    }

    #[cfg(test)]
    pub(crate) fn text(&self) -> &str {
        match &self.text {
            Text::Made(text) => text,
            Text::Common(text) => text,
            Text::Differing { .. } => "",
        }
    }

    pub(crate) async fn fetch_all<'c>(self, on: impl Into<On<'c>>) -> Result<Vec<T>, sqlx::Error> {
        let (rows, _) = run(on.into(), self.text, self.values).await?;
        rows.into_iter().map(|row| T::read(&row)).collect()
    }

    pub(crate) async fn fetch_optional<'c>(
        self,
        on: impl Into<On<'c>>,
    ) -> Result<Option<T>, sqlx::Error> {
        let (rows, _) = run(on.into(), self.text, self.values).await?;
        rows.first().map(T::read).transpose()
    }

    pub(crate) async fn fetch_one<'c>(self, on: impl Into<On<'c>>) -> Result<T, sqlx::Error> {
        let found = self.fetch_optional(on).await?;
        found.ok_or(sqlx::Error::RowNotFound)
    }

    /// Runs it. Gives back how many rows it has changed.
    pub(crate) async fn execute<'c>(self, on: impl Into<On<'c>>) -> Result<u64, sqlx::Error> {
        let (_, changed) = run(on.into(), self.text, self.values).await?;
        Ok(changed)
    }

    /// True if it finds a row.
    pub(crate) async fn exists<'c>(self, on: impl Into<On<'c>>) -> Result<bool, sqlx::Error> {
        Ok(self.fetch_optional(on).await?.is_some())
    }
}

/// A statement of one column.
pub(crate) struct Scalar<T>(Statement<(T,)>);

/// A statement whose rows have one column.
pub(crate) fn query_scalar<T: Cell>(text: impl Into<Text>) -> Scalar<T> {
    Scalar(query_as(text))
}

impl<T: Cell> Scalar<T> {
    pub(crate) fn bind(self, value: impl Into<Value>) -> Self {
        Self(self.0.bind(value))
    }

    pub(crate) async fn fetch_all<'c>(self, on: impl Into<On<'c>>) -> Result<Vec<T>, sqlx::Error> {
        let rows = self.0.fetch_all(on).await?;
        Ok(rows.into_iter().map(|(value,)| value).collect())
    }

    pub(crate) async fn fetch_optional<'c>(
        self,
        on: impl Into<On<'c>>,
    ) -> Result<Option<T>, sqlx::Error> {
        Ok(self.0.fetch_optional(on).await?.map(|(value,)| value))
    }

    pub(crate) async fn fetch_one<'c>(self, on: impl Into<On<'c>>) -> Result<T, sqlx::Error> {
        Ok(self.0.fetch_one(on).await?.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_counted_on_and_other_dollars_stay() {
        for (text, counted) in [
            ("select 1", "select 1"),
            (
                "where a = $1 and b = $12 or c = $1",
                "where a = $3 and b = $14 or c = $3",
            ),
            ("$2", "$4"),
            ("select '$', '$x', $1", "select '$', '$x', $3"),
        ] {
            assert_eq!(counted_on(text, 2), counted);
        }
        assert_eq!(counted_on("a = $1", 0), "a = $1");
    }

    #[tokio::test]
    async fn what_is_said_later_is_heard_before_the_next_with_parameters_of_its_own() {
        let pool = SqlitePool::connect("sqlite::memory:").await.unwrap();
        let mut connection = Pool::Sqlite(pool).acquire().await.unwrap();
        let insert = |first: i64, second: &str| {
            let insert = query("insert into pairs (word, number) values ($2 || '$', $1)");
            insert.bind(first).bind(second)
        };
        let table = query("create table pairs (number integer, word text)");
        connection.later(table).await.unwrap();
        for round in 0..2 {
            connection.later(insert(round, "a")).await.unwrap();
            connection.later(insert(round + 10, "b")).await.unwrap();
            let changed = query("update pairs set number = number + $1 where number >= $2")
                .bind(100_i64)
                .bind(10 + round);
            // Of all three the last one's.
            assert_eq!(
                changed.execute(&mut connection).await.unwrap(),
                1 + round as u64
            );
        }
        let select = "select number, word from pairs where word <> $1 order by number";
        let rows: Vec<(i64, String)> = query_as(select)
            .bind("c")
            .fetch_all(&mut connection)
            .await
            .unwrap();
        let words = rows.iter().map(|(number, word)| format!("{number}{word}"));
        assert_eq!(words.collect::<Vec<_>>(), ["0a$", "1a$", "111b$", "210b$"]);

        // The next statement shows its errors.
        connection
            .later(query("insert into nowhere values (1)"))
            .await
            .unwrap();
        assert!(query("select 1").execute(&mut connection).await.is_err());
    }
}
