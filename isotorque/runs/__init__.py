"""What one robot does from file to model: discover, learn, be judged; from recordings too."""
