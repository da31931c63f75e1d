// SPDX-License-Identifier: BSD-3-Clause
#ifndef Observed_h
#define Observed_h

#include "HasPart.h"

#include "vtkTestErrorObserver.h"

#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkExecutive.h>
#include <vtkNew.h>

#include <string>

/// A filter, and observers of its errors and warnings.
template <typename FilterT>
struct Observed
{
  Observed()
  {
    for (const unsigned long event : { vtkCommand::ErrorEvent, vtkCommand::WarningEvent })
    {
      this->Filter->AddObserver(event, this->Observer);
      this->Filter->GetExecutive()->AddObserver(event, this->ExecutiveObserver);
    }
  }

  void ClearMessages()
  {
    this->Observer->Clear();
    this->ExecutiveObserver->Clear();
  }

  /// Updates the filter and returns its error message, or "" without an error. The output must be
  /// empty after an error.
  std::string TryUpdate()
  {
    this->Filter->Modified();
    this->Filter->Update();
    const std::string errors = this->Observer->GetErrorMessage();
    EXPECT_EQ(errors.find("ERROR: "), errors.rfind("ERROR: "));
    if (!errors.empty())
    {
      // The next update reports the error again, although nothing has changed.
      this->Observer->Clear();
      EXPECT_FALSE(this->Filter->GetExecutive()->Update());
      EXPECT_TRUE(this->Observer->GetError());
      EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfPoints(), 0);
    }
    this->ClearMessages();
    return errors;
  }

  /// Updates the filter twice. Each time it must report one error that contains these words, and
  /// have an empty output.
  void VerifyFailure(const std::string& words)
  {
    for (int repeat = 0; repeat < 2; ++repeat) // nothing changes before the second update
    {
      EXPECT_FALSE(this->Filter->GetExecutive()->Update());
      const std::string message = this->Observer->GetErrorMessage();
      EXPECT_TRUE(HasPart(message, words));
      EXPECT_TRUE(HasPart(message, "ERROR: "));
      EXPECT_EQ(message.find("ERROR: "), message.rfind("ERROR: "));
      EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfPoints(), 0);
      this->ClearMessages();
    }
  }

  /// Updates the filter, and aborts the update at its first progress event. There must be no error,
  /// and the output must be empty.
  void Abort()
  {
    bool isAborted = false;
    vtkNew<vtkCallbackCommand> abort;
    abort->SetClientData(&isAborted);
    abort->SetCallback(
      [](vtkObject* caller, unsigned long, void* done, void*)
      {
        *static_cast<bool*>(done) = true;
        static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1);
      });
    const unsigned long tag = this->Filter->AddObserver(vtkCommand::ProgressEvent, abort);
    this->Filter->Update();
    EXPECT_TRUE(isAborted);
    EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfPoints(), 0);
    EXPECT_EQ(this->Observer->GetErrorMessage(), "");
    this->Filter->RemoveObserver(tag);
    this->Filter->SetAbortExecute(0);
    this->ClearMessages();
  }

  vtkNew<FilterT> Filter;
  vtkNew<vtkTest::ErrorObserver> Observer;
  vtkNew<vtkTest::ErrorObserver> ExecutiveObserver;
};

#endif
