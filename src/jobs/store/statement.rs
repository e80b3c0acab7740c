//! A statement, and what it is run on: the same words on SQLite and on PostgreSQL, except where [`dialect`](super::dialect)
//! has two texts for one meaning.
//!
//! The drivers are typed by their database. Here the choice is a value, made once when the store is opened; a statement
//! keeps its parameters until it knows which driver takes them.

use sqlx::postgres::{PgPool, PgRow, Postgres};
use sqlx::sqlite::{Sqlite, SqlitePool, SqliteRow};
use sqlx::{AssertSqlSafe, Executor, FromRow, PgConnection, SqlSafeStr, SqlStr, SqliteConnection};

/// What is kept of a database: its connections.
#[derive(Debug, Clone)]
pub(super) enum Pool {
    /// A file.
    Sqlite(SqlitePool),
    /// A server.
    Postgres(PgPool),
}

impl Pool {
    pub(super) fn dialect(&self) -> Dialect {
        match self {
            Self::Sqlite(_) => Dialect::Sqlite,
            Self::Postgres(_) => Dialect::Postgres,
        }
    }

    pub(super) async fn acquire(&self) -> Result<Connection, sqlx::Error> {
        Ok(match self {
            Self::Sqlite(pool) => Connection::Sqlite(pool.acquire().await?),
            Self::Postgres(pool) => Connection::Postgres(pool.acquire().await?),
        })
    }

    pub(super) fn is_closed(&self) -> bool {
        match self {
            Self::Sqlite(pool) => pool.is_closed(),
            Self::Postgres(pool) => pool.is_closed(),
        }
    }

    /// Comes when it is closed.
    pub(super) async fn closed(&self) {
        match self {
            Self::Sqlite(pool) => pool.close_event().await,
            Self::Postgres(pool) => pool.close_event().await,
        }
    }

    pub(super) async fn close(&self) {
        match self {
            Self::Sqlite(pool) => pool.close().await,
            Self::Postgres(pool) => pool.close().await,
        }
    }
}

/// Which of the two texts of a statement is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dialect {
    Sqlite,
    Postgres,
}

/// A connection that is held for a while.
pub(super) enum Connection {
    Sqlite(sqlx::pool::PoolConnection<Sqlite>),
    Postgres(sqlx::pool::PoolConnection<Postgres>),
}

impl Connection {
    pub(super) fn close_on_drop(&mut self) {
        match self {
            Self::Sqlite(connection) => connection.close_on_drop(),
            Self::Postgres(connection) => connection.close_on_drop(),
        }
    }

    /// Says something that is no query, without a statement of the driver's.
    pub(super) async fn say(&mut self, words: impl Into<Text>) -> Result<(), sqlx::Error> {
        let words = words.into();
        match self {
            Self::Sqlite(connection) => {
                if let Some(words) = words.of(Dialect::Sqlite) {
                    sqlx::raw_sql(words).execute(&mut **connection).await?;
                }
            }
            Self::Postgres(connection) => {
                if let Some(words) = words.of(Dialect::Postgres) {
                    sqlx::raw_sql(words).execute(&mut **connection).await?;
                }
            }
        }
        Ok(())
    }
}

/// What a statement is run on.
pub(super) enum On<'c> {
    Sqlite(&'c mut SqliteConnection),
    SqlitePool(&'c SqlitePool),
    Postgres(&'c mut PgConnection),
    PostgresPool(&'c PgPool),
}

impl<'c> From<&'c Pool> for On<'c> {
    fn from(pool: &'c Pool) -> Self {
        match pool {
            Pool::Sqlite(pool) => Self::SqlitePool(pool),
            Pool::Postgres(pool) => Self::PostgresPool(pool),
        }
    }
}

impl<'c> From<&'c mut Connection> for On<'c> {
    fn from(connection: &'c mut Connection) -> Self {
        match connection {
            Connection::Sqlite(connection) => Self::Sqlite(connection),
            Connection::Postgres(connection) => Self::Postgres(connection),
        }
    }
}

/// What can be read from a row of either database.
pub(super) trait Record:
    for<'r> FromRow<'r, SqliteRow> + for<'r> FromRow<'r, PgRow> + Send + Unpin
{
}

impl<T> Record for T where
    T: for<'r> FromRow<'r, SqliteRow> + for<'r> FromRow<'r, PgRow> + Send + Unpin
{
}

/// A row of which nothing is read.
pub(super) struct Nothing;

impl<R: sqlx::Row> FromRow<'_, R> for Nothing {
    fn from_row(_row: &R) -> Result<Self, sqlx::Error> {
        Ok(Self)
    }
}

/// The text of a statement.
#[derive(Debug, Clone)]
pub(super) enum Text {
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
            // Only words of this folder are pushed onto it; what comes from outside is bound.
            (Self::Made(text), _) => Some(AssertSqlSafe(text).into_sql_str()),
        }
    }
}

/// A parameter. Both databases know these kinds, and nothing else is kept.
#[derive(Debug, Clone)]
pub(super) enum Value {
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
    Option<String> => |value| Self::Text(value),
    Option<&String> => |value| Self::Text(value.cloned()),
    &Option<String> => |value| Self::Text(value.clone()),
    &[u8] => |value| Self::Bytes(value.to_owned()),
}

/// A statement with its parameters.
pub(super) struct Statement<T> {
    text: Text,
    values: Vec<Value>,
    reads: std::marker::PhantomData<fn() -> T>,
}

/// A statement of which no row is read.
pub(super) fn query(text: impl Into<Text>) -> Statement<Nothing> {
    query_as(text)
}

/// A statement whose rows are read as `T`.
pub(super) fn query_as<T: Record>(text: impl Into<Text>) -> Statement<T> {
    Statement {
        text: text.into(),
        values: Vec::new(),
        reads: std::marker::PhantomData,
    }
}

macro_rules! run {
    ($self:ident, $on:ident, $none:expr, |$executor:ident, $query:ident| $run:expr) => {{
        let Statement { text, values, .. } = $self;
        match $on.into() {
            On::Sqlite($executor) => match text.of(Dialect::Sqlite) {
                Some(text) => {
                    let $query = bind_sqlite::<T>(text, values);
                    $run
                }
                None => $none,
            },
            On::SqlitePool($executor) => match text.of(Dialect::Sqlite) {
                Some(text) => {
                    let $query = bind_sqlite::<T>(text, values);
                    $run
                }
                None => $none,
            },
            On::Postgres($executor) => match text.of(Dialect::Postgres) {
                Some(text) => {
                    let $query = bind_postgres::<T>(text, values);
                    $run
                }
                None => $none,
            },
            On::PostgresPool($executor) => match text.of(Dialect::Postgres) {
                Some(text) => {
                    let $query = bind_postgres::<T>(text, values);
                    $run
                }
                None => $none,
            },
        }
    }};
}

macro_rules! binding {
    ($name:ident, $database:ty) => {
        fn $name<T: Record>(
            text: SqlStr,
            values: Vec<Value>,
        ) -> sqlx::query::QueryAs<'static, $database, T, <$database as sqlx::Database>::Arguments> {
            let mut query = sqlx::query_as::<$database, T>(text);
            for value in values {
                query = match value {
                    Value::Integer(value) => query.bind(value),
                    Value::Text(value) => query.bind(value),
                    Value::Bytes(value) => query.bind(value),
                };
            }
            query
        }
    };
}

binding!(bind_sqlite, Sqlite);
binding!(bind_postgres, Postgres);

impl<T: Record> Statement<T> {
    /// The value of the next parameter: `$1`, then `$2`.
    pub(super) fn bind(mut self, value: impl Into<Value>) -> Self {
        self.values.push(value.into());
        self
    }

    /// Goes on with the text of a statement that is put together.
    pub(super) fn push(&mut self, words: &str) -> &mut Self {
        if let Text::Made(text) = &mut self.text {
            text.push_str(words);
        }
        self
    }

    /// The same with a parameter.
    pub(super) fn push_bind(&mut self, value: impl Into<Value>) -> &mut Self {
        self.values.push(value.into());
        let parameter = format!("${}", self.values.len());
        self.push(&parameter)
    }

    #[cfg(test)]
    pub(super) fn text(&self) -> &str {
        match &self.text {
            Text::Made(text) => text,
            Text::Common(text) => text,
            Text::Differing { .. } => "",
        }
    }

    pub(super) async fn fetch_all<'c>(self, on: impl Into<On<'c>>) -> Result<Vec<T>, sqlx::Error> {
        run!(self, on, Ok(Vec::new()), |executor, query| query
            .fetch_all(executor)
            .await)
    }

    pub(super) async fn fetch_optional<'c>(
        self,
        on: impl Into<On<'c>>,
    ) -> Result<Option<T>, sqlx::Error> {
        run!(self, on, Ok(None), |executor, query| query
            .fetch_optional(executor)
            .await)
    }

    pub(super) async fn fetch_one<'c>(self, on: impl Into<On<'c>>) -> Result<T, sqlx::Error> {
        run!(
            self,
            on,
            Err(sqlx::Error::RowNotFound),
            |executor, query| query.fetch_one(executor).await
        )
    }

    /// Runs it. Gives back how many rows it has changed.
    pub(super) async fn execute<'c>(self, on: impl Into<On<'c>>) -> Result<u64, sqlx::Error> {
        run!(self, on, Ok(0), |executor, query| executor
            .execute(query)
            .await
            .map(|done| done.rows_affected()))
    }

    /// Whether it finds a row.
    pub(super) async fn exists<'c>(self, on: impl Into<On<'c>>) -> Result<bool, sqlx::Error> {
        Ok(self.fetch_optional(on).await?.is_some())
    }
}

/// A statement of one column.
pub(super) struct Scalar<T>(Statement<(T,)>);

/// A statement whose rows have one column.
pub(super) fn query_scalar<T>(text: impl Into<Text>) -> Scalar<T>
where
    (T,): Record,
{
    Scalar(query_as(text))
}

impl<T> Scalar<T>
where
    (T,): Record,
{
    pub(super) fn bind(self, value: impl Into<Value>) -> Self {
        Self(self.0.bind(value))
    }

    pub(super) async fn fetch_all<'c>(self, on: impl Into<On<'c>>) -> Result<Vec<T>, sqlx::Error> {
        let rows = self.0.fetch_all(on).await?;
        Ok(rows.into_iter().map(|(value,)| value).collect())
    }

    pub(super) async fn fetch_optional<'c>(
        self,
        on: impl Into<On<'c>>,
    ) -> Result<Option<T>, sqlx::Error> {
        Ok(self.0.fetch_optional(on).await?.map(|(value,)| value))
    }

    pub(super) async fn fetch_one<'c>(self, on: impl Into<On<'c>>) -> Result<T, sqlx::Error> {
        Ok(self.0.fetch_one(on).await?.0)
    }
}
